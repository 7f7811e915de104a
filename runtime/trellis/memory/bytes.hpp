// SPDX-License-Identifier: GPL-3.0-or-later
// Little-endian bytes of numbers on every machine, for files and hashes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace trellis {

inline void put_integer(std::string& bytes, std::uint64_t value) {
  for (unsigned i = 0; i < 8; ++i) bytes += static_cast<char>((value >> (8U * i)) & 0xFFU);
}
inline void put_number(std::string& bytes, double value) { put_integer(bytes, std::bit_cast<std::uint64_t>(value)); }

/// Returns the number in the eight bytes from `at`, all of which must exist.
inline std::uint64_t integer_at(std::string_view bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + i])) << (8U * i);
  }
  return value;
}
inline double number_at(std::string_view bytes, std::size_t at) { return std::bit_cast<double>(integer_at(bytes, at)); }

}  // namespace trellis
