// Implements OpenGL without a screen, through an EGL context that has no surface.
// SPDX-License-Identifier: BSD-3-Clause
#include "egl_context.h"

#include <EGL/eglext.h>
#include <ddm_common/option_checks.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "ddm_mujoco/renderer.h"

namespace ddm {
namespace {

constexpr unsigned int kRenderer = 0x1F01;  // GL_RENDERER
constexpr unsigned int kVersion = 0x1F02;   // GL_VERSION

[[noreturn]] void failAt(const std::string& step) {
  throw std::runtime_error(
      textOf("images of a MuJoCo model need OpenGL without a screen (EGL, surfaceless): ", step,
             " failed, EGL error 0x", std::hex, eglGetError(),
             "; install Debian's libegl1 and libgl1-mesa-dri, which draw on any processor"));
}

/// Address of a function of OpenGL or EGL. Null if the function does not exist.
template <class Function>
Function openGl(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

/// Opens the only EGL display of this process. The display stays open until the process ends,
/// because drivers crash if a display is closed while another thread has a context.
///
/// LP_NUM_THREADS=0: Mesa's llvmpipe draws on the caller's thread. With threads of its own, version
/// 22.3.6 of Mesa has crashed (while it searched the resources of a scene), and small images are
/// not drawn faster.
///
/// LIBGL_ALWAYS_SOFTWARE=1: the CPU draws. Each graphics card draws slightly different pixels, and
/// a model that was trained on the images of one driver would get unfamiliar images from another
/// driver.
/// @throws std::runtime_error naming the step that fails; the next call tries again
EGLDisplay openDisplay() {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", /*overwrite=*/0);
  setenv("LP_NUM_THREADS", "0", /*overwrite=*/0);
  const auto platform_display = openGl<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (platform_display == nullptr) failAt("eglGetPlatformDisplayEXT");
  const EGLDisplay display =
      platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY) failAt("eglGetPlatformDisplayEXT");
  if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) failAt("eglInitialize");
  return display;
}

EGLDisplay display() {
  static const EGLDisplay display = openDisplay();
  return display;
}

}  // namespace

EglContext::EglContext() : display_(display()), context_(EGL_NO_CONTEXT) {
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) failAt("eglBindAPI");
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
    failAt("eglChooseConfig");
  }
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
  if (context_ == EGL_NO_CONTEXT) failAt("eglCreateContext");
}

EglContext::~EglContext() { eglDestroyContext(display_, context_); }

std::string openGlRenderer() {
  const EglContext context;
  const EglContext::Current current(context);
  const auto get = openGl<const char* (*)(unsigned int)>("glGetString");
  const auto text = [get](unsigned int name) {
    const char* const part = get == nullptr ? nullptr : get(name);
    return std::string(part == nullptr ? "unknown" : part);
  };
  return text(kRenderer) + ", " + text(kVersion);
}

EglContext::Current::Current(const EglContext& context) : display_(context.display_) {
  eglBindAPI(EGL_OPENGL_API);
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_) != EGL_TRUE) {
    failAt("eglMakeCurrent");
  }
}

EglContext::Current::~Current() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

}  // namespace ddm
