// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/mistakes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <dsl/lua/guard.hpp>
#include <dsl/lua/stack.hpp>
#include <trellis/base/errors.hpp>

namespace trellis::lua {

namespace {

std::vector<std::string> in_order(std::vector<Mistake> mistakes, const std::string& script) {
  // Files in the order of their first mistake, the script itself first.
  std::vector<std::string> files = {script};
  for (const Mistake& mistake : mistakes) {
    if (std::find(files.begin(), files.end(), mistake.script) == files.end()) files.push_back(mistake.script);
  }
  const auto rank = [&](const Mistake& mistake) {
    return std::pair(std::find(files.begin(), files.end(), mistake.script) - files.begin(), mistake.line);
  };
  std::stable_sort(mistakes.begin(), mistakes.end(),
                   [&](const Mistake& a, const Mistake& b) { return rank(a) < rank(b); });
  std::vector<std::string> messages;
  for (Mistake& mistake : mistakes) {
    if (std::find(messages.begin(), messages.end(), mistake.message) != messages.end()) continue;
    messages.push_back(std::move(mistake.message));
  }
  return messages;
}

/// As a list it has one element, so that loops over it end.
int element(Stack& call) {
  const auto* failed = call[1].get<FailedValue>();
  if (failed != nullptr) {
    if (const Mistake* mistake = failed->denied_by(call[2].string())) {
      Guard::withdraw(call.state(), *mistake);
      failed->withdraw();
      return call.result(false);
    }
    failed->insist();
  }
  const auto index = call[2].integer();
  if (index && *index != 1) {
    call.push_nil();
    return 1;
  }
  Guard::push_failed_value(call.state());
  return 1;
}

int failed_value(Stack& call) {
  for (int i = 1; i <= call.count(); ++i) {
    if (const auto* failed = call[i].get<FailedValue>()) failed->insist();
  }
  Guard::push_failed_value(call.state());
  return 1;
}

int pairs_of_one(Stack& call) {
  call.push_function([done = false](Stack& step) mutable {
    if (std::exchange(done, true)) {
      step.push_nil();
      return 1;
    }
    step.push(std::int64_t{1});
    Guard::push_failed_value(step.state());
    return 2;
  });
  return 1;
}

}  // namespace

Mistakes::Mistakes(std::vector<Mistake> mistakes, const std::string& script)
    : Mistakes(in_order(std::move(mistakes), script)) {}

Mistakes::Mistakes(std::vector<std::string> messages)
    : Error(fmt::format("{}", fmt::join(shortened(messages), "\n"))),
      count_(messages.size()),
      messages_(shortened(std::move(messages))) {}

const Mistake* FailedValue::denied_by(const std::optional<std::string>& field) const {
  return denial_ && field == denial_->field ? &denial_->mistake : nullptr;
}

void FailedValue::insist() const {
  if (denial_ && denial_->withdrawn) throw Located(denial_->mistake.message);
}

bool Faults::attempt(const std::function<void()>& body) {
  try {
    body();
    return true;
  } catch (const FailedValue&) {
    failed_value_ = true;
  } catch (const Located&) {
    throw;
  } catch (const SeveralFaults& several) {
    messages_.insert(messages_.end(), several.messages().begin(), several.messages().end());
  } catch (const Errors& errors) {
    messages_.insert(messages_.end(), errors.messages().begin(), errors.messages().end());
  } catch (const Error& error) {
    messages_.emplace_back(error.what());
  }
  return false;
}

void Faults::raise() const {
  if (messages_.size() == 1) throw Error(messages_.front());
  if (!messages_.empty()) throw SeveralFaults(messages_);
  if (failed_value_) throw FailedValue();
}

void declare_failed_value(Stack& stack) {
  Metamethods all = {{"__index", element},
                     {"__pairs", pairs_of_one},
                     {"__newindex", [](Stack&) { return 0; }},
                     {"__len", [](Stack& call) { return call.result(std::int64_t{1}); }},
                     {"__tostring", [](Stack& call) { return call.result("?"); }}};
  for (const char* event : {"__call", "__add", "__sub", "__mul", "__div", "__mod", "__pow", "__unm", "__idiv", "__band",
                            "__bor", "__bxor", "__bnot", "__shl", "__shr", "__lt", "__le", "__concat"}) {
    all.emplace_back(event, failed_value);
  }
  stack.declare<FailedValue>(all);
}

}  // namespace trellis::lua
