// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/state.hpp>

#include <fmt/format.h>
#include <pthread.h>
#include <time.h>  // NOLINT(modernize-deprecated-headers): clock_gettime is POSIX's

#include <algorithm>
#include <condition_variable>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <dsl/lua/guard.hpp>
#include <trellis/base/errors.hpp>

namespace trellis::lua {

namespace {

/// Names the reason of "attempt to call a world value (local 'world')" in the message at index 1: the local hides a
/// word of the language.
void add_hiding_hint(lua_State* state) {
  const std::string message = lua_type(state, 1) == LUA_TSTRING ? lua_tostring(state, 1) : "";
  if (message.find("attempt to call") == std::string::npos || !message.ends_with("')")) return;
  for (const std::string_view kind : {"(local '", "(upvalue '"}) {
    const std::size_t at = message.rfind(kind);
    if (at == std::string::npos) continue;
    const std::size_t begin = at + kind.size();
    const std::string name = message.substr(begin, message.size() - 2 - begin);
    lua_pushglobaltable(state);
    lua_pushlstring(state, name.data(), name.size());
    const int type = lua_rawget(state, -2);
    lua_settop(state, 1);
    if (type == LUA_TNIL) return;
    std::string hint = message;
    hint.append("; the local '").append(name).append("' hides the word of the language: rename it");
    lua_pushlstring(state, hint.data(), hint.size());
    lua_replace(state, 1);
    return;
  }
}

/// Formats a message with a traceback. Removes frames without information: those of the script's caller, of `error`
/// itself, and of the script's main chunk if it is the only frame and the message already has its line.
std::string tidy(const std::string& message) {
  constexpr std::string_view head = "\nstack traceback:";
  const auto begin = message.rfind(head);
  if (begin == std::string::npos) return message;
  std::string text = message.substr(0, begin);
  std::string frames;
  std::size_t count = 0;
  std::string_view rest = std::string_view(message).substr(begin + head.size());
  while (!rest.empty()) {
    const std::string_view frame = rest.substr(0, rest.find('\n', 1));
    rest.remove_prefix(frame.size());
    if (frame == "\n\t[C]: in ?" || frame == "\n\t[C]: in function 'error'") continue;
    frames += frame;
    ++count;
  }
  constexpr std::string_view main_chunk = " in main chunk";
  if (count == 0) return text;
  if (count == 1 && frames.ends_with(main_chunk)) {
    const std::string place = frames.substr(2, frames.size() - 2 - main_chunk.size());
    if (text.starts_with(place)) return text;
  }
  return text + std::string(head) + frames;
}

/// Returns the time of a thread's processor clock; 0 if the thread has ended.
double processor_seconds(clockid_t clock) {
  timespec time{};
  if (::clock_gettime(clock, &time) != 0) return 0.0;
  constexpr double nano = 1e-9;
  return static_cast<double>(time.tv_sec) + nano * static_cast<double>(time.tv_nsec);
}

constexpr int hook_interval = 100;  // Lua instructions between two checks of the limits

int run_body(lua_State* state) {
  const auto* body = static_cast<const std::function<void(Stack&)>*>(lua_touserdata(state, 1));
  lua_settop(state, 0);
  return Guard::run(state, [body](Stack& stack) {
    (*body)(stack);
    return 0;
  });
}

}  // namespace

int Guard::run(lua_State* state, const Callback& body) {
  // Raise after the handlers have ended: Lua raises with its own exception type, and unwinding destroys the message.
  // That exception is no std::exception, so no handler here catches it.
  constexpr std::uint64_t least = 50;  // minimal cost of a call between Lua and C++, in instructions
  spend(state, least);
  std::string message;
  bool noted = false;
  FailedValue denied;
  try {
    Stack stack(state);
    return body(stack);
  } catch (const FailedValue&) {
    noted = true;
  } catch (const Located& error) {
    message = error.what();
    noted = State::of(state).note(state, {message}, true);
  } catch (const DeniedError& error) {
    const auto position = Stack(state).where();
    message = (position ? position->prefix() : "") + error.what();
    noted = State::of(state).note(state, {error.what()}, false);
    if (const auto* mistakes = State::of(state).work_.mistakes;
        noted && mistakes->back().message.ends_with(error.what())) {
      denied = FailedValue(error.field(), mistakes->back());
    }
  } catch (const EndingError& error) {
    const auto position = Stack(state).where();
    message = (position ? position->prefix() : "") + error.what();
  } catch (const SeveralFaults& faults) {
    const auto position = Stack(state).where();
    message = (position ? position->prefix() : "") + faults.what();
    noted = State::of(state).note(state, faults.messages(), false);
  } catch (const Errors& errors) {
    const auto position = Stack(state).where();
    message = (position ? position->prefix() : "") + errors.what();
    noted = State::of(state).note(state, errors.messages(), false);
  } catch (const Error& error) {
    const auto position = Stack(state).where();
    message = (position ? position->prefix() : "") + error.what();
    noted = State::of(state).note(state, {error.what()}, false);
  } catch (const std::exception& error) {
    State::of(state).work_.fault = std::current_exception();
    State::of(state).work_.ended = true;
    message = error.what();
  }
  lua_settop(state, 0);
  if (noted) {
    Stack(state).push_object(std::move(denied));
    return 1;
  }
  State::of(state).work_.raised = message;
  lua_pushlstring(state, message.data(), message.size());
  return lua_error(state);
}

void Guard::withdraw(lua_State* state, const Mistake& mistake) {
  auto& work = State::of(state).work_;
  if (work.mistakes == nullptr) return;
  const auto same = std::find_if(work.mistakes->begin(), work.mistakes->end(), [&](const Mistake& other) {
    return other.script == mistake.script && other.line == mistake.line && other.message == mistake.message;
  });
  if (same != work.mistakes->end()) work.mistakes->erase(same);
  if (work.mistakes->empty()) work.last = State::Work().last;
}

void Guard::push_failed_value(lua_State* state) { Stack(state).push_object(FailedValue()); }

void Guard::pass_on(lua_State* state) {
  if (State::of(state).work_.ended) State::unwind(state);
}

int Guard::explain(lua_State* state) {
  if (State::of(state).work_.ended) return 1;
  const int type = lua_type(state, 1);
  if (type == LUA_TSTRING) {
    std::size_t size = 0;
    const char* text = lua_tolstring(state, 1, &size);
    if (std::string_view(text, size) == State::of(state).work_.raised) return 1;
  } else if (luaL_callmeta(state, 1, "__tostring") != 0 && lua_type(state, -1) == LUA_TSTRING) {
    lua_replace(state, 1);
  } else if (type != LUA_TNUMBER) {
    lua_pushfstring(state, "an error was thrown that is no text but a %s", luaL_typename(state, 1));
    lua_replace(state, 1);
  }
  lua_settop(state, 1);
  add_hiding_hint(state);
  luaL_traceback(state, state, lua_tostring(state, 1), 1);
  return 1;
}

State::State(Options options)
    : options_(std::move(options)), budget_{.limit = options_.memory, .longest_string = options_.longest_string} {
  state_ = lua_newstate(&State::allocate, &budget_);
  if (state_ == nullptr) throw Error(out_of_memory());
  *static_cast<State**>(lua_getextraspace(state_)) = this;
  // Coroutines inherit the hook of their creator.
  lua_sethook(state_, &State::count, LUA_MASKCOUNT, hook_interval);
  if (options_.stuck) watchdog_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

State::~State() { lua_close(state_); }

State& State::of(lua_State* state) { return **static_cast<State**>(lua_getextraspace(state)); }

void* State::allocate(void* budget, void* block, std::size_t old_size, std::size_t new_size) {
  auto& [used, limit, longest_string, string_refused] = *static_cast<Budget*>(budget);
  if (block == nullptr) {
    string_refused =
        old_size == LUA_TSTRING && new_size > longest_string;  // for new blocks Lua passes their type in old_size
    if (string_refused) return nullptr;
    old_size = 0;
  }
  if (new_size == 0) {
    std::free(block);  // NOLINT(cppcoreguidelines-no-malloc): Lua's allocator is realloc by contract
    used -= old_size;
    return nullptr;
  }
  if (new_size > old_size && new_size - old_size > limit - used) return nullptr;
  void* grown = std::realloc(block, new_size);  // NOLINT(cppcoreguidelines-no-malloc)
  if (grown != nullptr) used += new_size - old_size;
  return grown;
}

void State::count(lua_State* state, lua_Debug* frame) {
  static_cast<void>(frame);
  State& self = of(state);
  const int interval = lua_gethookcount(state);
  // Shorter intervals on a slow machine must not move the end of a script, so the limit sees whole intervals alone.
  self.work_.partial += interval;
  if (self.work_.partial >= hook_interval) {
    self.work_.spent += hook_interval;
    self.work_.partial -= hook_interval;
  }
  const auto before = self.work_.looked;
  self.look_around(state);
  // If instructions are slow, check sooner. Once may be another process that had the processor.
  constexpr auto slow = std::chrono::milliseconds(10), quick = std::chrono::milliseconds(1);
  const auto took = self.work_.looked - before;
  const bool again = std::exchange(self.work_.was_slow, took > slow);
  const bool whole = self.work_.partial == 0;
  int next = interval;
  if (took > slow && again) next = std::max(1, interval / 10);
  if (took < quick && whole) next = hook_interval;
  if (next == interval) return;
  lua_sethook(state, &State::count, LUA_MASKCOUNT, next);
  // It visits all active calls, which takes milliseconds in a deep recursion. That is not the script's slowness.
  self.work_.looked = Clock::now();
}

void State::spend(lua_State* state, std::uint64_t instructions) {
  constexpr unsigned calls = 16;
  constexpr std::uint64_t many = 1000;
  if (work_.ended) unwind(state);
  work_.spent += instructions;
  const bool beyond = work_.limits != nullptr && work_.spent > work_.limits->instructions;
  if (++work_.calls < calls && instructions < many && !beyond) return;
  look_around(state);
}

void State::look_around(lua_State* state) {
  work_.calls = 0;
  if (work_.ended) unwind(state);
  if (work_.limits == nullptr) return;  // no run: the state is closing
  work_.looked = Clock::now();
  if (work_.spent > std::min(work_.last, work_.limits->instructions)) {
    end(state, fmt::format("{} has spent {} instructions and does not terminate{}", work_.limits->subject,
                           work_.limits->instructions, work_.limits->advice));
  }
  if (worked_too_long()) {
    end(state, fmt::format("{} has worked for {:g} s and does not terminate{}", work_.limits->subject,
                           work_.limits->seconds, work_.limits->advice));
  }
  if (!options_.poll) return;
  try {
    options_.poll();
    return;
  } catch (const std::exception&) {
    work_.fault = std::current_exception();
    work_.ended = true;
  }
  unwind(state);
}

bool State::worked_too_long() {
  // The limit is processor time: other load on the machine does not count. Reading it costs more than the wall clock,
  // so read that first.
  constexpr double noticed = 0.01;
  const double passed = std::chrono::duration<double>(work_.looked - work_.begin).count();
  if (passed < noticed) return false;
  if (work_.begin_cpu < 0.0) work_.begin_cpu = processor_seconds(CLOCK_THREAD_CPUTIME_ID);
  return passed > work_.limits->seconds &&
         processor_seconds(CLOCK_THREAD_CPUTIME_ID) - work_.begin_cpu > work_.limits->seconds;
}

bool State::note(lua_State* state, const std::vector<std::string>& messages, bool located) {
  constexpr std::size_t most = 1000;
  constexpr std::uint64_t afterwards = 50'000'000;  // instructions after the first mistake
  if (work_.mistakes == nullptr || work_.catching > 0 || work_.ended) return false;
  // Code between the user's and this call, such as the standard library's, expects an error to end it.
  lua_Debug frame{};
  for (int level = 0; lua_getstack(state, level, &frame) != 0; ++level) {
    lua_getinfo(state, "Sl", &frame);
    if (frame.currentline > 0) break;
    frame = {};
  }
  if (frame.currentline <= 0 || frame.source[0] != '@') return false;
  if (work_.mistakes->empty()) work_.last = work_.spent + afterwards;
  const Position position{frame.source + 1, frame.currentline};
  for (const std::string& message : messages) {
    if (work_.mistakes->size() >= most) break;
    work_.mistakes->push_back({position.script, position.line, (located ? "" : position.prefix()) + message});
  }
  return true;
}

void State::end(lua_State* state, const std::string& why) {
  work_.ended = true;
  const auto position = Stack(state).where();
  work_.ended_by = (position ? position->prefix() : "") + why;
  luaL_checkstack(state, LUA_MINSTACK, nullptr);
  luaL_traceback(state, state, work_.ended_by.c_str(), 0);
  work_.ended_by = lua_tostring(state, -1);
  unwind(state);
}

void State::unwind(lua_State* state) {
  // In a hook, the stack is the hooked function's: its values stay.
  if (lua_checkstack(state, 1) != 0) lua_pushboolean(state, 0);
  lua_error(state);
  std::abort();  // unreachable: lua_error does not return, but is not declared noreturn
}

std::string State::out_of_memory() const {
  if (budget_.string_refused) {
    return fmt::format("the script makes a string of more than the {} MiB that one may have",
                       budget_.longest_string >> 20U);
  }
  return fmt::format("the script needs more memory than the {} MiB it may use", budget_.limit >> 20U);
}

void State::watch(const std::stop_token& stop) {
  constexpr auto interval = std::chrono::milliseconds(100);
  constexpr double grace = 5.0;  // seconds beyond the limit, for a slow end
  std::condition_variable_any asleep;
  std::unique_lock lock(watching_);
  std::uint64_t seen = 0;
  double begin = 0.0;
  while (!stop.stop_requested()) {
    const std::uint64_t run = active_run_.load();
    const double now = run != 0 ? processor_seconds(clock_.load()) : 0.0;
    if (run != 0 && run == seen && now - begin > watched_seconds_.load() + grace) {
      options_.stuck("the script does not terminate: a single instruction takes far longer than the limit");
    }
    if (run != seen) begin = now;
    seen = run;
    asleep.wait_for(lock, stop, interval, [] { return false; });
  }
}

void State::run(const std::function<void(Stack&)>& body, const Limits& limits, std::vector<Mistake>* mistakes) {
  constexpr std::size_t longest_line = 1000;  // longer first lines are cut
  if (lua_checkstack(state_, 3) == 0) throw Error(out_of_memory());
  // Intervals begin with the run, whatever ran before.
  const auto restart = [this] {
    work_.partial = 0;
    lua_sethook(state_, &State::count, LUA_MASKCOUNT, hook_interval);
  };
  restart();
  Work outer = std::exchange(work_, Work());
  work_.limits = &limits;
  work_.mistakes = mistakes;
  work_.begin = work_.looked = Clock::now();
  const auto watch = [this] {
    watched_seconds_ = work_.limits->seconds;
    active_run_ = work_.number = ++runs_;
  };
  if (options_.stuck) {
    clockid_t clock = CLOCK_THREAD_CPUTIME_ID;
    ::pthread_getcpuclockid(::pthread_self(), &clock);
    clock_ = clock;
    watch();
  }
  const int before = lua_gettop(state_);
  // None of these three calls allocates, so none can fail outside of a protected call.
  lua_pushcfunction(state_, Guard::explain);
  lua_pushcfunction(state_, run_body);
  lua_pushlightuserdata(state_, const_cast<std::function<void(Stack&)>*>(&body));  // NOLINT: only called
  const int status = lua_pcall(state_, 1, 0, before + 1);
  active_run_ = 0;
  Work done = std::exchange(work_, std::move(outer));
  restart();
  if (work_.number != 0) watch();
  if (status == LUA_OK && !done.ended) {
    lua_settop(state_, before);
    if (done.fault) std::rethrow_exception(done.fault);
    return;
  }
  std::string message;
  if (done.ended) {
    message = done.ended_by;
  } else if (status == LUA_ERRMEM) {
    message = out_of_memory();
  } else if (status != LUA_OK) {
    std::size_t size = 0;
    const char* text = lua_tolstring(state_, -1, &size);
    message = text != nullptr ? std::string(text, size) : "an error was thrown that cannot be shown";
  }
  message = tidy(message);
  if (const auto end = std::min(message.find('\n'), message.size()); end > longest_line) {
    message.replace(longest_line, end - longest_line, "...");
  }
  lua_settop(state_, before);
  if (done.fault) std::rethrow_exception(done.fault);
  if (done.ended || status == LUA_ERRMEM) throw Exhausted(message);
  throw Located(message);
}

Reference::Reference(const Stack& stack, Value value) : interpreter_(State::of(stack.state()).weak_from_this()) {
  luaL_checkstack(stack.state(), 2, "too many values");
  lua_pushvalue(stack.state(), value.index());
  key_ = luaL_ref(stack.state(), LUA_REGISTRYINDEX);
}

Reference::~Reference() {
  // Frees a slot of the registry; this allocates nothing and so cannot fail. If the interpreter is being destroyed, so
  // is the registry.
  if (const auto interpreter = interpreter_.lock()) luaL_unref(interpreter->state_, LUA_REGISTRYINDEX, key_);
}

void Reference::push(Stack& stack) const {
  luaL_checkstack(stack.state(), 1, "too many values");
  lua_rawgeti(stack.state(), LUA_REGISTRYINDEX, key_);
}

}  // namespace trellis::lua
