// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <exception>
#include <thread>

#include <trellis/base/error.hpp>
#include <trellis/strategy/sampler.hpp>

namespace trellis {

namespace {

constexpr std::size_t place(Who who) { return static_cast<std::size_t>(who); }

}  // namespace

Bounded::Bounded(double bound, std::uint64_t slice) : bound_(bound), slice_(slice) {
  if (!(bound > 1.0) || !std::isfinite(bound)) throw Error("bounded loss needs a bound of more than 1");
  if (slice == 0) throw Error("bounded loss needs a slice of at least 1 check");
}

Who Bounded::next() const {
  if (ended_[place(Who::alone)]) return Who::guided;
  if (ended_[place(Who::guided)]) return Who::alone;
  // It begins, so that random numbers which both share in order are those that it has without the other.
  if (checks_[place(Who::alone)] == 0) return Who::alone;
  const double allowed = (bound_ - 1.0) * static_cast<double>(checks_[place(Who::alone)]);
  const auto guided = static_cast<double>(checks_[place(Who::guided)]);
  return guided <= allowed + static_cast<double>(slice_) ? Who::guided : Who::alone;
}

void Bounded::spent(Who who, std::uint64_t checks) {
  std::unique_lock lock(mutex_);
  checks_[place(who)] += checks;
  if (next() == who || found_) return;
  turn_.notify_all();
  turn_.wait(lock, [&] { return next() == who || found_.has_value(); });
}

bool Bounded::over() const {
  const std::lock_guard lock(mutex_);
  return found_.has_value();
}

std::uint64_t Bounded::checks(Who who) const {
  const std::lock_guard lock(mutex_);
  return checks_[place(who)];
}

bool Bounded::take_part(Who who, const std::function<bool()>& planner) {
  {
    std::unique_lock lock(mutex_);
    turn_.wait(lock, [&] { return next() == who || found_.has_value(); });
    if (found_) return false;
  }
  return planner();
}

std::optional<Who> Bounded::run(const std::function<bool()>& alone, const std::function<bool()>& guided) {
  checks_ = {};
  ended_ = {};
  found_.reset();
  std::array<std::exception_ptr, 2> faults;
  const auto body = [&](Who who, const std::function<bool()>& planner) {
    bool found = false;
    try {
      found = take_part(who, planner);
    } catch (...) {
      faults[place(who)] = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ended_[place(who)] = true;
    if (found && !found_) found_ = who;
    turn_.notify_all();
  };
  std::thread beside([&] { body(Who::alone, alone); });
  body(Who::guided, guided);
  beside.join();
  for (const Who who : {Who::guided, Who::alone}) {
    if (faults[place(who)]) std::rethrow_exception(faults[place(who)]);
  }
  return found_;
}

}  // namespace trellis
