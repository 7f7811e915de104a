// SPDX-License-Identifier: GPL-3.0-or-later
// The CSV files of `trellis measure`.
#include <dsl/command/store/csv.hpp>

#include "fuzz.hpp"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile file("samples.csv");
  return trellis::fuzz::examine([&] {
    static_cast<void>(trellis::command::read_csv(file.write(data, size), {"x", "y", "theta"}, "case.json: samples"));
  });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
