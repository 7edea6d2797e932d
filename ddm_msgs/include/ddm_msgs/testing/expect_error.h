// Errors of a given type whose text a user can act on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace ddm {
namespace testing {

/// Whether `action` throws this type, with all the parts in its message.
template <class Error>
::testing::AssertionResult throwsNaming(const std::function<void()>& action,
                                        const std::vector<std::string>& parts) {
  try {
    action();
  } catch (const Error& e) {
    for (const std::string& part : parts) {
      if (std::string(e.what()).find(part) == std::string::npos) {
        return ::testing::AssertionFailure() << "no '" << part << "' in: " << e.what();
      }
    }
    return ::testing::AssertionSuccess();
  } catch (const std::exception& e) {
    return ::testing::AssertionFailure() << "another type of error: " << e.what();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

}  // namespace testing
}  // namespace ddm
