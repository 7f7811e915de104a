// SPDX-License-Identifier: GPL-3.0-or-later
// Libraries of stored paths.
#include <trellis/memory/library.hpp>

#include "fuzz.hpp"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile file("paths.db");
  return trellis::fuzz::examine([&] {
    const trellis::Library library(file.write(data, size));
    static_cast<void>(library.paths());
  });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
