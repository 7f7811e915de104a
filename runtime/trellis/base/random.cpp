// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/random.hpp>

#include <Random123/philox.h>

#include <cmath>
#include <numbers>
#include <string>

namespace trellis {

std::uint64_t stable_hash(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : bytes) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  return hash;
}

Stream::Stream(std::uint64_t seed, std::string_view level, std::string_view purpose) {
  std::string name(level);
  name.push_back('\0');
  name.append(purpose);
  key_ = {seed, stable_hash(name)};
}

void Stream::refill() {
  using Generator = r123::Philox4x64;
  const Generator::key_type key = {{key_[0], key_[1]}};
  for (std::size_t i = 0; i < block_.size(); i += 4) {
    const Generator::ctr_type counter = {{counter_++, 0, 0, 0}};
    const auto out = Generator{}(counter, key);
    for (std::size_t j = 0; j < 4; ++j) block_[i + j] = out[j];
  }
  next_ = 0;
}

double Stream::normal() {
  if (has_reserve_) {
    has_reserve_ = false;
    return reserve_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  reserve_ = radius * std::sin(angle);
  has_reserve_ = true;
  return radius * std::cos(angle);
}

}  // namespace trellis
