// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace trellis::test {

/// Removes the times of runs, which no run repeats, from a JSON document and everything in it.
template <class Json>
void remove_times(Json& json) {
  if (json.is_object()) {
    json.erase("time_s");
    json.erase("cpu_s");
    json.erase("lua_s");
    json.erase("lua_share");
    json.erase("path_cpu_s");
    json.erase("set_up_s");
    json.erase("shared_set_up_s");
  }
  if (json.is_structured()) {
    for (Json& part : json) remove_times(part);
  }
}

}  // namespace trellis::test
