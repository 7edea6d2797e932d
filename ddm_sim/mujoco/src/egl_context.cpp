// OpenGL without a screen: an EGL context on no surface.
// SPDX-License-Identifier: BSD-3-Clause
#include "egl_context.h"

#include <EGL/eglext.h>

#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

constexpr unsigned int kMaxRenderbufferSize = 0x84E8;  // GL_MAX_RENDERBUFFER_SIZE
constexpr unsigned int kRenderer = 0x1F01;             // GL_RENDERER
constexpr unsigned int kVersion = 0x1F02;              // GL_VERSION

[[noreturn]] void refuse(const std::string& step) {
  std::ostringstream message;
  message << "pictures of a MuJoCo model need OpenGL without a screen (EGL, surfaceless): " << step
          << " failed, EGL error 0x" << std::hex << eglGetError()
          << "; install Debian's libegl1 and libgl1-mesa-dri, which draw on any processor";
  throw std::runtime_error(message.str());
}

/// The one display of this process. It stays open until the process ends: drivers do not survive
/// being closed while a context of another thread lives. Mesa's llvmpipe draws on the caller's
/// thread, unless LP_NUM_THREADS asks for more: with threads of its own, version 22.3.6 has crashed
/// (in a search of the resources of a scene), and small pictures are not drawn faster. Software
/// draws unless LIBGL_ALWAYS_SOFTWARE says otherwise: graphics cards draw other pixels, each its
/// own, and a model that has learned from the one's images sees new things in the other's.
/// @throws std::runtime_error; the next call tries again
EGLDisplay openDisplay() {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", /*overwrite=*/0);
  setenv("LP_NUM_THREADS", "0", /*overwrite=*/0);
  const auto platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (platform_display == nullptr) refuse("eglGetPlatformDisplayEXT");
  const EGLDisplay display =
      platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY) refuse("eglGetPlatformDisplayEXT");
  if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) refuse("eglInitialize");
  return display;
}

EGLDisplay display() {
  static const EGLDisplay display = openDisplay();
  return display;
}

}  // namespace

EglContext::EglContext() : display_(display()), context_(EGL_NO_CONTEXT) {
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) refuse("eglBindAPI");
  const EGLint wanted[][2] = {{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT},
                              {EGL_RED_SIZE, 8},
                              {EGL_GREEN_SIZE, 8},
                              {EGL_BLUE_SIZE, 8},
                              {EGL_ALPHA_SIZE, 8},
                              {EGL_DEPTH_SIZE, 24},
                              {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT},
                              {EGL_NONE, EGL_NONE}};
  EGLConfig config = nullptr;
  EGLint found = 0;
  if (eglChooseConfig(display_, *wanted, &config, 1, &found) != EGL_TRUE || found < 1) {
    refuse("eglChooseConfig");
  }
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
  if (context_ == EGL_NO_CONTEXT) refuse("eglCreateContext");
}

EglContext::~EglContext() { eglDestroyContext(display_, context_); }

int EglContext::maxSize() const {
  using GetIntegerv = void (*)(unsigned int, int*);
  const auto get = reinterpret_cast<GetIntegerv>(eglGetProcAddress("glGetIntegerv"));
  int size = 0;
  if (get != nullptr) get(kMaxRenderbufferSize, &size);
  return size;
}

std::string EglContext::renderer() const {
  using GetString = const unsigned char* (*)(unsigned int);
  const auto get = reinterpret_cast<GetString>(eglGetProcAddress("glGetString"));
  std::string text;
  for (const unsigned int name : {kRenderer, kVersion}) {
    const unsigned char* const part = get == nullptr ? nullptr : get(name);
    text += (text.empty() ? "" : ", ") +
            std::string(part == nullptr ? "unknown" : reinterpret_cast<const char*>(part));
  }
  return text;
}

EglContext::Current::Current(const EglContext& context)
    : display_(context.display_),
      display_before_(eglGetCurrentDisplay()),
      context_before_(eglGetCurrentContext()),
      draw_before_(eglGetCurrentSurface(EGL_DRAW)),
      read_before_(eglGetCurrentSurface(EGL_READ)) {
  eglBindAPI(EGL_OPENGL_API);
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_) != EGL_TRUE) {
    refuse("eglMakeCurrent");
  }
}

EglContext::Current::~Current() {
  if (context_before_ == EGL_NO_CONTEXT) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  } else {
    eglMakeCurrent(display_before_, draw_before_, read_before_, context_before_);
  }
}

}  // namespace ddm
