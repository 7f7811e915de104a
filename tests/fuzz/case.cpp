// SPDX-License-Identifier: GPL-3.0-or-later
// The cases of `trellis measure`.
#include <dsl/command/case_file.hpp>

#include "fuzz.hpp"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile file("case.json");
  return trellis::fuzz::examine([&] {
    static_cast<void>(trellis::command::read_case(file.write(data, size),
                                                  {.memory = std::size_t{64} << 20U, .instructions = 1'000'000}));
  });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
