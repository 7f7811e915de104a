// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>

#include <unistd.h>

#include <trellis/base/error.hpp>

// Fuzzing of every reader. Each subject is a program with one function, LLVMFuzzerTestOneInput. With the preset `fuzz`
// libFuzzer drives it; else replay.cpp runs the files of corpus/SUBJECT and mutations of them. A finding is a crash, a
// time limit that passes, or an exception other than Error.

namespace trellis::fuzz {

/// Runs `body`; Error is the correct answer to bad input.
template <class Body>
int examine(Body body) {
  try {
    body();
  } catch (const Error&) {
  }
  return 0;
}

/// A file with the input, in memory if the system has a folder there. One per process; the next input overwrites it.
class InputFile {
 public:
  explicit InputFile(const std::string& name) {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder = std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    root_ = folder / ("trellis-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(root_ / "input");
    path_ = (root_ / "input" / name).string();
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  const std::string& write(const std::uint8_t* data, std::size_t size) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path_;
  }
  [[nodiscard]] std::filesystem::path folder() const { return root_ / "input"; }

 private:
  std::filesystem::path root_;
  std::string path_;
};

/// Returns the input with a few of its bytes, numbers or lines changed.
std::string mutated_text(std::string input, std::mt19937_64& random);

/// A number at the end of a range: 0, subnormal, huge, infinite, not a number, powers of two and neighbours.
std::string extreme_number(std::mt19937_64& random);

/// Returns another input for the subject; each subject defines it.
std::string mutated(const std::string& input, std::mt19937_64& random);

/// Returns an element of a list, at random.
template <class List>
const auto& any_of(const List& list, std::mt19937_64& random) {
  return list[random() % list.size()];
}

}  // namespace trellis::fuzz

// The names are those of libFuzzer.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
