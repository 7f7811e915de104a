// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/nested_lists.hpp>

#include <fmt/format.h>

#include <algorithm>

#include <dsl/language/core/construct.hpp>
#include <trellis/base/error.hpp>

namespace trellis::dsl {

bool NestedLists::count() {
  if (read_ > most_) return false;
  if (++read_ > most_) {
    throw Error(fmt::format("{}the lists have over {} values; a table that is in several lists counts in each", prefix_,
                            most_));
  }
  return true;
}

NestedLists::Within::Within(NestedLists& lists, lua::Value list, const std::string& what) : lists_(lists) {
  const void* identity = list.identity();
  auto& within = lists.within_;
  if (std::find(within.begin(), within.end(), identity) != within.end()) {
    throw Error(fmt::format("{}{} is a list that contains itself (a cycle)", lists.prefix_, what));
  }
  if (within.size() >= deepest_list) {
    throw Error(fmt::format("{}lists are nested over {} deep", lists.prefix_, deepest_list));
  }
  within.push_back(identity);
}

}  // namespace trellis::dsl
