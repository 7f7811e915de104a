// SPDX-License-Identifier: GPL-3.0-or-later
// The files of trained models.
#include <trellis/base/random.hpp>
#include <trellis/memory/bytes.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/memory/model_file.hpp>
#include <trellis/memory/search_model.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "fuzz.hpp"

namespace {

/// Makes the lengths and the hash of a model those of its bytes, so that the forest itself is read.
std::string repaired(std::string model) {
  constexpr std::size_t word = 8;
  for (const trellis::ModelKind* kind : {&trellis::cell_classifier, &trellis::search_heuristic}) {
    const std::size_t head = kind->magic.size() + 5 * word;
    if (!model.starts_with(kind->magic) || model.size() < head + word) continue;
    model.resize(model.size() - word);
    const std::size_t description =
        std::min<std::size_t>(trellis::integer_at(model, kind->magic.size() + 3 * word), model.size() - head);
    std::string numbers;
    trellis::put_integer(numbers, kind->version);
    trellis::put_integer(numbers, kind->features);
    trellis::put_integer(numbers, trellis::integer_at(model, kind->magic.size() + 2 * word));
    trellis::put_integer(numbers, description);
    trellis::put_integer(numbers, model.size() - head - description);
    model.replace(kind->magic.size(), numbers.size(), numbers);
    trellis::put_integer(model, trellis::stable_hash(model));
    return model;
  }
  return model;
}

/// Loads a model and evaluates it.
void load(const std::string& path) {
  trellis::fuzz::examine([&] {
    const trellis::ModelFile file = trellis::read_model(trellis::cell_classifier, path);
    static_cast<void>(file.forest(std::vector<double>(trellis::cell_classifier.features, 0.5)));
  });
  trellis::fuzz::examine([&] {
    const trellis::ModelFile file = trellis::read_model(trellis::search_heuristic, path);
    static_cast<void>(file.forest(std::vector<double>(trellis::search_heuristic.features, 0.5)));
  });
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile file("model");
  load(file.write(data, size));
  const std::string whole = repaired(std::string(reinterpret_cast<const char*>(data), size));
  load(file.write(reinterpret_cast<const std::uint8_t*>(whole.data()), whole.size()));
  return 0;
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
