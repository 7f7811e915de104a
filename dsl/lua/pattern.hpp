// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string_view>

namespace trellis::lua {

/// Matches one of Lua's patterns (Lua's manual, 6.4.1) in a text. Matching can take exponential time, so the matcher
/// reports its work to a callback, which may throw.
class Matcher {
 public:
  static constexpr std::size_t most_captures = 32;
  static constexpr std::size_t npos = std::string_view::npos;

  struct Capture {
    std::size_t begin = 0;
    std::size_t length = 0;
    bool place = false;  ///< `()`: it captures the position, not the text
  };

  /// \param pattern  without the anchor
  /// \param work     called with the work since its last call, in units of some nanoseconds
  Matcher(std::string_view text, std::string_view pattern, std::function<void(std::size_t)> work);
  ~Matcher() = default;
  Matcher(const Matcher&) = delete;
  Matcher& operator=(const Matcher&) = delete;

  /// Matches at one position of the text. \return the end of the match, npos without one. \throws Error for a malformed
  /// pattern.
  std::size_t match(std::size_t at);
  /// Reports the remaining work.
  void report_work();

  // Of the last match.
  [[nodiscard]] std::size_t captures() const { return count_; }
  /// \throws Error for an unfinished capture.
  [[nodiscard]] const Capture& capture(std::size_t i) const;

 private:
  static constexpr std::size_t open = npos;  // the length of an unfinished capture

  std::size_t step(std::size_t at, std::size_t p, int depth);
  std::size_t repeat(std::size_t at, std::size_t p, std::size_t next, int depth);
  std::size_t repeat_least(std::size_t at, std::size_t p, std::size_t next, int depth);
  std::size_t begin_capture(std::size_t at, std::size_t p, bool place, int depth);
  std::size_t end_capture(std::size_t at, std::size_t p, int depth);
  std::size_t balanced(std::size_t at, std::size_t p);
  std::size_t repeated_capture(std::size_t at, char digit);
  [[nodiscard]] std::size_t end_of_class(std::size_t p) const;
  [[nodiscard]] bool single(std::size_t at, std::size_t p, std::size_t next);
  [[nodiscard]] bool in_set(unsigned char c, std::size_t p, std::size_t last) const;
  void did(std::size_t steps = 1);

  std::string_view text_;
  std::string_view pattern_;
  std::function<void(std::size_t)> work_;
  std::size_t done_ = 0;  // since the last report
  std::size_t count_ = 0;
  std::array<Capture, most_captures> captures_;
};

}  // namespace trellis::lua
