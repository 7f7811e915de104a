// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/axes_json.hpp>

#include <utility>

namespace trellis {

using Json = nlohmann::ordered_json;

Json axes_json(const Space& space) {
  Json out = Json::array();
  for (const Axis& axis : space.coordinates()) {
    out.push_back({axis.name, axis.lo, axis.hi, axis.periodic ? 1 : 0, axis.weight});
  }
  return out;
}

Json rotations_json(const Space& space) {
  Json out = Json::array();
  for (const Factor& factor : space.factors()) {
    if (factor.kind == Factor::Kind::rotation) out.push_back(factor.column);
  }
  return out;
}

Json traces_json(const std::vector<Trace>& traces) {
  Json out = Json::array();
  for (const Trace& trace : traces) {
    Json one = {{"robot", trace.robot}, {"position", trace.axes}};
    if (trace.axes.empty()) {
      one["tip"] = {trace.tip.body, trace.tip.point.x, trace.tip.point.y, trace.tip.point.z};
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace trellis
