// Class EglContext: OpenGL without a screen, through an EGL context that has no surface.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <EGL/egl.h>

namespace ddm {

/// Owns one OpenGL context. The context is current on a thread only while an object of class
/// Current exists there. OpenGL calls on a thread without a current context do nothing and report
/// no error; class Current is therefore the only code that makes a context current.
class EglContext {
 public:
  /// @throws std::runtime_error naming the step that failed and the remedy
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

 private:
  EGLDisplay display_;
  EGLContext context_;
};

}  // namespace ddm
