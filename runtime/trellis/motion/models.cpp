// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/motion/motion_model.hpp>

namespace trellis {

namespace {

struct SpeedSettings {
  double min_speed = -0.5;
  double max_speed = 0.5;
  double dt = 0.1;
};

struct Unicycle1Settings : SpeedSettings {
  double max_angular_speed = 0.5;
};

struct Unicycle2Settings : Unicycle1Settings {
  double max_acceleration = 0.25;
  double max_angular_acceleration = 0.25;
  double speed_weight = 0.25;
  double angular_speed_weight = 0.25;
};

struct CarSettings : SpeedSettings {
  CarSettings() { min_speed = -0.1; }
  double wheelbase = 0.25;
  double max_steering = std::numbers::pi / 3.0;
};

struct TrailerSettings : CarSettings {
  double hitch = 0.5;
  double max_articulation = std::numbers::pi / 4.0;
};

template <class S>
Settings<S> described(const char* name, const char* summary, const char* source) {
  Settings<S> settings(Component::Kind::motion, name, summary, source);
  settings.number("min_speed", &S::min_speed, "m/s", Range::any(), "the least speed; negative: it goes backwards")
      .number("max_speed", &S::max_speed, "m/s", Range::positive(), "the greatest speed")
      .number("dt", &S::dt, "s", Range::positive(),
              "one step of the integration; controls are constant over whole steps");
  return settings;
}

template <class S>
Settings<S> with_turning(Settings<S> settings) {
  return settings.number("max_angular_speed", &S::max_angular_speed, "rad/s", Range::positive(),
                         "the greatest angular speed, in either direction");
}

template <class S>
Settings<S> with_steering(Settings<S> settings) {
  return settings.number("wheelbase", &S::wheelbase, "m", Range::positive(), "the distance between its axles")
      .number("max_steering", &S::max_steering, "rad",
              {.lo = 0, .hi = std::numbers::pi / 2, .open_lo = true, .open_hi = true},
              "the greatest angle of its front wheels, in either direction");
}

const Settings<Unicycle1Settings>& unicycle1_settings() {
  static const auto settings = with_turning(
      described<Unicycle1Settings>("unicycle1", "drives at a speed and turns at an angular speed that are its controls",
                                   "LaValle 2006, Planning Algorithms, section 13.1.2"));
  return settings;
}

const Settings<Unicycle2Settings>& unicycle2_settings() {
  static const auto settings =
      with_turning(described<Unicycle2Settings>(
                       "unicycle2", "a unicycle whose state holds its speeds and whose controls are accelerations",
                       "LaValle 2006, Planning Algorithms, section 13.2.3"))
          .number("max_acceleration", &Unicycle2Settings::max_acceleration, "m/s^2", Range::positive(),
                  "the greatest acceleration, in either direction")
          .number("max_angular_acceleration", &Unicycle2Settings::max_angular_acceleration, "rad/s^2",
                  Range::positive(), "the greatest angular acceleration, in either direction")
          .number("speed_weight", &Unicycle2Settings::speed_weight, "m per m/s", Range::positive(),
                  "metres of the metric per unit of speed")
          .number("angular_speed_weight", &Unicycle2Settings::angular_speed_weight, "m per rad/s", Range::positive(),
                  "metres of the metric per unit of angular speed");
  return settings;
}

const Settings<CarSettings>& car_settings() {
  static const auto settings = with_steering(
      described<CarSettings>("car", "drives at a speed and steers by its front wheels; its turning radius is bounded",
                             "LaValle 2006, Planning Algorithms, section 13.1.2"));
  return settings;
}

const Settings<TrailerSettings>& trailer_settings() {
  static const auto settings =
      with_steering(described<TrailerSettings>("car_with_trailer",
                                               "a car that pulls a trailer with a heading of its own",
                                               "LaValle 2006, Planning Algorithms, section 13.1.2"))
          .number("hitch", &TrailerSettings::hitch, "m", Range::positive(),
                  "from the car's reference point, where the trailer is hitched, to the trailer's axle")
          .number("max_articulation", &TrailerSettings::max_articulation, "rad",
                  {.lo = 0, .hi = std::numbers::pi, .open_lo = true}, "the greatest angle between car and trailer");
  return settings;
}

std::string text_of(const Component& component, const Options& options) {
  std::string given;
  for (std::size_t i = 0; i < options.entries().size(); ++i) {
    const auto& [name, value] = options.entries()[i];
    if (value == component.options[i].default_value) continue;
    given += fmt::format("{}{} = {}", given.empty() ? "" : ", ", name, to_string(value));
  }
  return given.empty() ? component.name : fmt::format("{} {{ {} }}", component.name, given);
}

ControlAxis speed_control(const Component& component, const SpeedSettings& s) {
  if (!(s.min_speed < s.max_speed)) {
    throw Error(fmt::format("{}: min_speed ({:g}) must be less than max_speed ({:g})", component.name, s.min_speed,
                            s.max_speed));
  }
  return {"speed", s.min_speed, s.max_speed};
}

class Unicycle1 final : public MotionModel {
 public:
  Unicycle1(const Unicycle1Settings& s, const Component& component, std::string text)
      : MotionModel(component.name, std::move(text), 3, {},
                    {speed_control(component, s), {"angular_speed", -s.max_angular_speed, s.max_angular_speed}}, s.dt) {
  }
  void derivative(View x, View u, MutableView rate) const override {
    rate[0] = u[0] * std::cos(x[2]);
    rate[1] = u[0] * std::sin(x[2]);
    rate[2] = u[1];
  }
};

class Unicycle2 final : public MotionModel {
 public:
  Unicycle2(const Unicycle2Settings& s, const Component& component, std::string text)
      : MotionModel(component.name, std::move(text), 3, velocities(component, s),
                    {{"acceleration", -s.max_acceleration, s.max_acceleration},
                     {"angular_acceleration", -s.max_angular_acceleration, s.max_angular_acceleration}},
                    s.dt) {}
  void derivative(View x, View u, MutableView rate) const override {
    rate[0] = x[3] * std::cos(x[2]);
    rate[1] = x[3] * std::sin(x[2]);
    rate[2] = x[4];
    rate[3] = u[0];
    rate[4] = u[1];
  }

 private:
  static std::vector<Axis> velocities(const Component& component, const Unicycle2Settings& s) {
    const ControlAxis speed = speed_control(component, s);
    return {{"v", speed.lo, speed.hi, s.speed_weight, false},
            {"omega", -s.max_angular_speed, s.max_angular_speed, s.angular_speed_weight, false}};
  }
};

class Car final : public MotionModel {
 public:
  Car(const CarSettings& s, const Component& component, std::string text)
      : MotionModel(component.name, std::move(text), 3, {},
                    {speed_control(component, s), {"steering", -s.max_steering, s.max_steering}}, s.dt),
        wheelbase_(s.wheelbase) {}
  void derivative(View x, View u, MutableView rate) const override {
    rate[0] = u[0] * std::cos(x[2]);
    rate[1] = u[0] * std::sin(x[2]);
    rate[2] = u[0] / wheelbase_ * std::tan(u[1]);
  }

 private:
  double wheelbase_;
};

class CarWithTrailer final : public MotionModel {
 public:
  CarWithTrailer(const TrailerSettings& s, const Component& component, std::string text)
      : MotionModel(component.name, std::move(text), 4, {},
                    {speed_control(component, s), {"steering", -s.max_steering, s.max_steering}}, s.dt),
        wheelbase_(s.wheelbase),
        hitch_(s.hitch),
        max_articulation_(s.max_articulation) {}
  void derivative(View x, View u, MutableView rate) const override {
    rate[0] = u[0] * std::cos(x[2]);
    rate[1] = u[0] * std::sin(x[2]);
    rate[2] = u[0] / wheelbase_ * std::tan(u[1]);
    rate[3] = u[0] / hitch_ * std::sin(x[2] - x[3]);
  }
  [[nodiscard]] bool admits(View x) const override {
    return std::abs(std::remainder(x[2] - x[3], 2.0 * std::numbers::pi)) <= max_articulation_;
  }

 private:
  double wheelbase_;
  double hitch_;
  double max_articulation_;
};

template <class Model, auto SettingsOf>
MotionKind kind() {
  return {&SettingsOf().component(), [](const Options& options) -> std::shared_ptr<const MotionModel> {
            const Component& component = SettingsOf().component();
            return std::make_shared<const Model>(SettingsOf().read(options), component, text_of(component, options));
          }};
}

}  // namespace

const std::vector<MotionKind>& motion_kinds() {
  static const std::vector<MotionKind> kinds = {kind<Unicycle1, unicycle1_settings>(),
                                                kind<Unicycle2, unicycle2_settings>(), kind<Car, car_settings>(),
                                                kind<CarWithTrailer, trailer_settings>()};
  return kinds;
}

const MotionKind* find_motion(std::string_view name) {
  const auto& kinds = motion_kinds();
  const auto it = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.component->name == name; });
  return it != kinds.end() ? &*it : nullptr;
}

}  // namespace trellis
