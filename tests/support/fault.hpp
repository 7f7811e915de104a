// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/base/error.hpp>

namespace trellis::test {

/// The message of the Error that a call throws, "" where it throws none.
template <class F>
std::string fault_of(const F& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace trellis::test
