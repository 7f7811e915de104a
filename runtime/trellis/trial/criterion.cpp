// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/trial/criterion.hpp>

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis::trial {

std::string_view to_string(Criterion::Kind kind) {
  switch (kind) {
    case Criterion::Kind::at_least: return "at least";
    case Criterion::Kind::at_most: return "at most";
    case Criterion::Kind::below: return "below";
    case Criterion::Kind::above: return "above";
    case Criterion::Kind::exactly: return "exactly";
  }
  throw Fault("unknown kind of criterion");
}

std::string_view to_string(Quantity quantity) {
  switch (quantity) {
    case Quantity::none: return "nothing";
    case Quantity::validity_checks: return "validity checks";
    case Quantity::motion_checks: return "motion checks";
    case Quantity::proposals: return "proposals";
    case Quantity::nodes: return "nodes";
  }
  throw Fault("unknown quantity");
}

Criterion::Criterion(Kind kind, double value) : kind_(kind), value_(value) {
  if (!std::isfinite(value)) throw Error(fmt::format("{} takes a finite number, got {}", to_string(kind), value));
}

Criterion::Criterion(Kind kind, Trial other) : kind_(kind), other_(std::move(other)) {
  if (kind != Kind::below && kind != Kind::above) throw Fault("two trials are compared by below and above only");
}

Criterion Criterion::by(double margin) const {
  if (!other_) throw Error(fmt::format("by: '{}' compares with no other trial", text()));
  if (!(std::isfinite(margin) && margin >= 0.0)) {
    throw Error(fmt::format("by: a margin is a number of at least 0, got {:g}", margin));
  }
  Criterion changed = *this;
  changed.margin_ = margin;
  return changed;
}

Criterion Criterion::with_confidence(double confidence) const {
  if (!(confidence > 0.5 && confidence < 1.0)) {
    throw Error(fmt::format("with_confidence: a confidence is a number greater than 0.5 and less than 1, got {:g}",
                            confidence));
  }
  Criterion changed = *this;
  changed.confidence_ = confidence;
  return changed;
}

Criterion Criterion::of(Quantity quantity) const {
  Criterion changed = *this;
  changed.quantity_ = quantity;
  return changed;
}

Criterion Criterion::in_level(std::string level) const {
  Criterion changed = *this;
  changed.level_ = std::move(level);
  return changed;
}

bool Criterion::met_by(double figure) const {
  switch (kind_) {
    case Kind::at_least: return figure >= value_;
    case Kind::at_most: return figure <= value_;
    case Kind::below: return figure < value_;
    case Kind::above: return figure > value_;
    case Kind::exactly: return figure == value_;
  }
  throw Fault("unknown kind of criterion");
}

std::string Criterion::text() const {
  if (!other_) return fmt::format("{} {:g}", to_string(kind_), value_);
  return fmt::format("{} than {}", from_above() ? "less" : "more", other_->name());
}

}  // namespace trellis::trial
