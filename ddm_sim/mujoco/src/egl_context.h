// OpenGL without a screen: an EGL context on no surface.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <EGL/egl.h>

#include <string>

namespace ddm {

/// A context of its own, current on a thread only while a Current is alive there. OpenGL calls
/// on a thread without a context do nothing and report nothing, so nothing else makes it current.
class EglContext {
 public:
  /// @throws std::runtime_error naming the step that failed, and what helps
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes a context current on this thread for its lifetime.
  class Current {
   public:
    /// @throws std::runtime_error if another thread holds the context
    explicit Current(const EglContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    EGLDisplay display_;
  };

  /// Largest side of an image that this driver can draw [pixels].
  /// @pre this context is current
  int maxSize() const;

  /// GL_RENDERER and GL_VERSION: "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (...) Mesa 22.3.6".
  /// @pre this context is current
  std::string renderer() const;

 private:
  EGLDisplay display_;
  EGLContext context_;
};

}  // namespace ddm
