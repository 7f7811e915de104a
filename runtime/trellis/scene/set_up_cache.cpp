// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/set_up_cache.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <set>
#include <utility>

namespace trellis {

constinit thread_local OwnSetUps* thread_set_ups = nullptr;

OwnSetUpsScope::OwnSetUpsScope(OwnSetUps* own)
    : outer_(own != nullptr ? std::exchange(thread_set_ups, own) : thread_set_ups) {}

OwnSetUpsScope::~OwnSetUpsScope() { thread_set_ups = outer_; }

namespace {

constinit thread_local SharedSetUps* thread_record = nullptr;
constinit thread_local SetUpUse* thread_use = nullptr;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double cpu_now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  constexpr double nano = 1e-9;
  return static_cast<double>(time.tv_sec) + nano * static_cast<double>(time.tv_nsec);
}

double sum(const std::vector<std::shared_ptr<const SetUpTime>>& times, std::set<const SetUpTime*>& counted) {
  double seconds = 0.0;
  for (const auto& time : times) {
    if (counted.insert(time.get()).second) seconds += time->seconds + sum(time->uses, counted);
  }
  return seconds;
}

}  // namespace

double SharedSetUps::seconds() const {
  std::set<const SetUpTime*> counted;
  return sum(used_, counted);
}

SharedSetUpsScope::SharedSetUpsScope(SharedSetUps* record) : outer_(std::exchange(thread_record, record)) {}

SharedSetUpsScope::~SharedSetUpsScope() { thread_record = outer_; }

SetUpUse::SetUpUse() : outer_(std::exchange(thread_use, this)), begin_(now()), cpu_begin_(cpu_now()) {}

SetUpUse::~SetUpUse() {
  thread_use = outer_;
  const double spent = now() - begin_;
  if (outer_ != nullptr) {
    outer_->within_ += spent;
    if (time_) outer_->uses_.push_back(time_);
  } else if (thread_record != nullptr) {
    thread_record->spent_ += spent;
    thread_record->cpu_spent_ += cpu_now() - cpu_begin_;
    auto& used = thread_record->used_;
    if (time_ && std::find(used.begin(), used.end(), time_) == used.end()) used.push_back(time_);
  }
}

std::shared_ptr<const SetUpTime> SetUpUse::computed() const {
  return std::make_shared<const SetUpTime>(SetUpTime{now() - begin_ - within_, uses_});
}

}  // namespace trellis
