// SPDX-License-Identifier: GPL-3.0-or-later
// The files of trained models.
#include <trellis/memory/model.hpp>
#include <trellis/memory/search_model.hpp>

#include "fuzz.hpp"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile file("model");
  const std::string& path = file.write(data, size);
  trellis::fuzz::examine([&] { static_cast<void>(trellis::Model::load(path)); });
  return trellis::fuzz::examine([&] { static_cast<void>(trellis::SearchModel::load(path)); });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
