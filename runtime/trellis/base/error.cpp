// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/error.hpp>

#include <algorithm>
#include <numeric>
#include <vector>

namespace trellis {

namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view given, std::span<const std::string> known) {
  // A name of that length is not misspelt, and the time grows with its square.
  constexpr std::size_t most = 200;
  const std::string* best = nullptr;
  std::size_t least = 0;
  for (const auto& name : known) {
    if (given.size() > most || name.size() > most) continue;
    const std::size_t longer = std::max(given.size(), name.size());
    // Two changes leave next to nothing of three letters, unless they swap them: rtr is near rrt, but foo not near box.
    const bool swapped = given.size() == name.size() && std::is_permutation(given.begin(), given.end(), name.begin());
    const std::size_t allowed = longer <= 3 && !swapped ? 1 : std::max<std::size_t>(2, longer / 3);
    const std::size_t length = std::min(given.size(), name.size());
    if (std::max(given.size(), name.size()) - length > allowed) continue;  // a lower bound of the distance
    const std::size_t distance = edit_distance(given, name);
    if (distance <= allowed && distance < length && (best == nullptr || distance < least)) {
      best = &name;
      least = distance;
    }
  }
  return best != nullptr ? *best : std::string{};
}

std::string did_you_mean(std::string_view given, std::span<const std::string> known) {
  const std::string name = nearest_name(given, known);
  return name.empty() ? std::string{} : " (did you mean '" + name + "'?)";
}

}  // namespace trellis
