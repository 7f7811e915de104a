// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/schedule.hpp>

#include <algorithm>
#include <utility>

namespace trellis {

ScheduleSearch::ScheduleSearch(Instance& paths, std::size_t cells)
    : paths_(paths),
      cells_(cells),
      start_(paths.space.dimension(), '\0'),
      goal_(paths.space.dimension(), static_cast<char>(cells)) {
  reached_from_.emplace(start_, start_);
  open_.emplace(start_.size() * cells_, ~added_, start_);
}

Configuration ScheduleSearch::at(const Place& place) const {
  Configuration s(place.size());
  for (std::size_t g = 0; g < s.size(); ++g) {
    const double share = static_cast<double>(place[g]) / static_cast<double>(cells_);
    s[g] = paths_.start[g] + share * (paths_.goal()[g] - paths_.start[g]);
  }
  return s;
}

void ScheduleSearch::reach(const Place& from, const Configuration& at_from, const Place& next) {
  if (reached_from_.contains(next) || !paths_.motion(at_from, at(next)).valid) return;
  reached_from_.emplace(next, from);
  std::size_t left = 0;
  for (const char moved : next) left += cells_ - static_cast<std::size_t>(moved);
  // The fewest cells left first; of equal ones the one found last, so that the search continues from there.
  open_.emplace(left, ~++added_, next);
}

std::optional<Configurations> ScheduleSearch::expand() {
  const Place here = std::get<2>(open_.top());
  open_.pop();
  ++expanded_;
  const Configuration from = at(here);
  Place next = here;
  for (char& moved : next) moved = std::min(static_cast<char>(cells_), static_cast<char>(moved + 1));
  reach(here, from, next);
  for (std::size_t g = 0; g < here.size(); ++g) {
    for (const int by : {-1, 1}) {
      next = here;
      next[g] = static_cast<char>(std::clamp(here[g] + by, 0, static_cast<int>(cells_)));
      if (next != here) reach(here, from, next);
    }
  }
  if (!reached_from_.contains(goal_)) return std::nullopt;
  std::vector<Place> places = {goal_};
  while (places.back() != start_) places.push_back(reached_from_.at(places.back()));
  Configurations path(start_.size());
  for (std::size_t i = places.size(); i-- > 0;) path.push(at(places[i]));
  return path;
}

}  // namespace trellis
