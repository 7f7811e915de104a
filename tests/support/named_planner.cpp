// SPDX-License-Identifier: GPL-3.0-or-later
// named_planner NAME ARGUMENTS...: the command `trellis` with a planner of that name, which draws proposals and finds
// no path, and with two that draw none: `waits` does not override Planner::work, `works` does nothing there.
#include <iostream>
#include <optional>
#include <string>
#include <utility>

#include <trellis/planner/own_planner.hpp>
#include <trellis/program.hpp>

namespace {

using namespace trellis;

std::string& name() {
  static std::string given;
  return given;
}

const Settings<CommonSettings>& settings() {
  static const auto all =
      with_common(Settings<CommonSettings>(Component::Kind::planner, name(), "draws and finds no path", ""));
  return all;
}

class Drawing final : public Planner {
 public:
  Drawing(const CommonSettings& /*settings*/, PlannerContext context) : Planner(std::move(context)) {}

  std::optional<Status> begin(const Budget& /*budget*/) override {
    root_ = add_node(context_, context_.instance.start);
    return std::nullopt;
  }
  Outcome extend(View proposal) override { return {.proposal = proposal}; }
  Solution solution(Status status) override { return {status, branch_to(context_.search, root_)}; }

 private:
  std::uint32_t root_ = no_node;
};

/// Plans steps without proposals alone.
class Waiting : public Planner {
 public:
  Waiting(const CommonSettings& /*settings*/, PlannerContext context) : Planner(std::move(context)) {}

  std::optional<Status> begin(const Budget& /*budget*/) override {
    root_ = add_node(context_, context_.instance.start);
    return std::nullopt;
  }
  bool draws() const override { return false; }
  Plan plan() override { return {.proposal = false}; }
  Outcome extend(View /*proposal*/) override { return {}; }
  Solution solution(Status status) override { return {status, branch_to(context_.search, root_)}; }

 private:
  std::uint32_t root_ = no_node;
};

class Working final : public Waiting {
 public:
  using Waiting::Waiting;
  std::optional<Status> work() override { return std::nullopt; }
};

const Settings<CommonSettings>& waiting_settings() {
  static const auto all =
      with_common(Settings<CommonSettings>(Component::Kind::planner, "waits", "plans steps that it does not have", ""));
  return all;
}
const Settings<CommonSettings>& working_settings() {
  static const auto all =
      with_common(Settings<CommonSettings>(Component::Kind::planner, "works", "works without an end", ""));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  name() = argc > 1 ? argv[1] : "";
  try {
    register_planner<settings, Drawing>();
    register_planner<waiting_settings, Waiting>();
    register_planner<working_settings, Working>();
  } catch (const Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
  return run_program(argc - 1, argv + 1);
}
