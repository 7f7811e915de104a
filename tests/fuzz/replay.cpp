// SPDX-License-Identifier: GPL-3.0-or-later
// The main program of a fuzz subject without libFuzzer: PROGRAM [--mutations N] [--seed N] FILE|FOLDER...
// Runs each file and N mutations of it (default 50), the same ones for the same seed. Prints the number of inputs. An
// exception other than Error ends it with status 1 and writes the input to fuzz-finding.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iterator>
#include <vector>

#include "fuzz.hpp"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(const std::vector<std::string>& places) {
  std::vector<fs::path> files;
  for (const fs::path place : places) {
    if (!fs::is_directory(place)) {
      files.push_back(place);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(place)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Writes the input before it runs, so that a crash leaves it.
void run(const std::string& input) {
  std::ofstream("fuzz-finding", std::ios::binary) << input;
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

}  // namespace

int main(int count, char** words) {
  std::uint64_t mutations = 50;
  std::uint64_t seed = 1;
  std::vector<std::string> places;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool option = (word == "--mutations" || word == "--seed") && i + 1 < count;
    if (option) {
      (word == "--seed" ? seed : mutations) = std::stoull(words[++i]);
    } else {
      places.push_back(word);
    }
  }
  std::size_t inputs = 0;
  try {
    const auto files = files_of(places);
    if (files.empty()) {
      std::fprintf(stderr, "%s: no input in the given places\n", words[0]);
      return 2;
    }
    std::mt19937_64 random(seed);
    for (const fs::path& file : files) {
      std::ifstream stream(file, std::ios::binary);
      const std::string input{std::istreambuf_iterator<char>(stream), {}};
      run(input);
      for (std::uint64_t i = 0; i < mutations; ++i) run(trellis::fuzz::mutated(input, random));
      inputs += 1 + mutations;
    }
  } catch (const std::exception& finding) {
    std::fprintf(stderr, "%s: %s: the input is in fuzz-finding\n", words[0], finding.what());
    return 1;
  }
  fs::remove("fuzz-finding");
  std::printf("%zu inputs, no finding\n", inputs);
  return 0;
}
