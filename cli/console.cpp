#include "console.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "flag_text.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/output/provenance.h"

namespace pellicle::cli {

Console::Console()
    : logger_(std::make_shared<spdlog::logger>("pellicle", std::make_shared<spdlog::sinks::stderr_sink_mt>())) {
  logger_->set_pattern("%v");
  logger_->set_level(spdlog::level::warn);
}

Console::~Console() {
  clear_bar();
}

void Console::configure(const ConsoleOptions& options) {
  options_ = options;
  logger_->set_level(options.quiet ? spdlog::level::err : options.verbose ? spdlog::level::info : spdlog::level::warn);
}

void Console::inform(const std::string& message) {
  log(spdlog::level::info, "info", with_flags(message));
}
void Console::notice(const std::string& message) {
  log(spdlog::level::warn, "note", with_flags(message));
}
void Console::warn(const std::string& message) {
  log(spdlog::level::warn, "warning", with_flags(message));
}
void Console::error(const std::string& message) {
  log(spdlog::level::err, "error", message);
}

void Console::log(int level, const char* name, const std::string& message) {
  const auto severity = static_cast<spdlog::level::level_enum>(level);
  if (!logger_->should_log(severity)) return;
  clear_bar();
  std::string line = message;
  std::replace(line.begin(), line.end(), '\n', ' ');
  line = fmt::format("pellicle: {}: {}", name, line);
  if (options_.json) {
    const nlohmann::ordered_json record{{"time", utc_time()}, {"level", name}, {"message", line}};
    line = record.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  logger_->log(severity, "{}", line);
  logger_->flush();
}

void Console::clear_bar() {
  if (!bar_shown_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  bar_shown_ = false;
}

// Seconds left when the rest goes as the part so far did; nothing before that means something.
std::string Console::remaining(double fraction) const {
  const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  if (fraction < 0.05 || spent < 1.0) return "";
  const auto left = static_cast<long>(std::ceil(spent * (1.0 - fraction) / fraction));
  if (left >= 3600) return fmt::format("{}:{:02}:{:02} left ", left / 3600, left / 60 % 60, left % 60);
  return fmt::format("{}:{:02} left ", left / 60, left % 60);
}

Observer Console::observer() {
  return {.progress = [this](double fraction, const std::string& what) { progress(fraction, what); },
          .inform = [this](const std::string& message) { inform(message); },
          .warn = [this](const std::string& message) { warn(message); },
          .stopped = interrupt_requested};
}

void Console::progress(double fraction, const std::string& what) {
  if (options_.quiet || options_.no_progress || options_.json || isatty(STDERR_FILENO) == 0) return;
  if (fraction >= 1.0) {
    clear_bar();
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (bar_shown_ && now - last_bar_ < std::chrono::milliseconds(100)) return;
  last_bar_ = now;
  constexpr int cells = 30;
  const int full = static_cast<int>(cells * std::clamp(fraction, 0.0, 1.0));
  const std::string bar =
      std::string(static_cast<std::size_t>(full), '#') + std::string(static_cast<std::size_t>(cells - full), '-');
  std::fputs(
      fmt::format("\r\033[K[{}] {:3.0f}% {}{}", bar, 100.0 * fraction, remaining(fraction), what.substr(0, 40)).c_str(),
      stderr);
  std::fflush(stderr);
  bar_shown_ = true;
}

}  // namespace pellicle::cli
