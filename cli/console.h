#pragma once
/// All that goes to the terminal beside results: logs, the progress bar, the one line of an error. Everything here is
/// stderr; stdout belongs to results.

#include <chrono>
#include <memory>
#include <string>

#include "pellicle/base/observer.h"

namespace spdlog {
class logger;
}

namespace pellicle::cli {

struct ConsoleOptions {
  bool quiet = false;        ///< errors only
  bool verbose = false;      ///< also what is being done
  bool json = false;         ///< one JSON object per line
  bool no_progress = false;  ///< no bar even on a terminal
};

class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void configure(const ConsoleOptions& options);
  void inform(const std::string& message);
  /// What a user should know though nothing is wrong.
  void notice(const std::string& message);
  void warn(const std::string& message);
  /// `pellicle: error: MESSAGE`, line breaks turned into spaces.
  void error(const std::string& message);
  /// The console as the host of a run: messages, the bar, and whether a signal asked to stop. It must outlive the run.
  Observer observer();
  /// Draws the bar, with the time that is left, when stderr is a terminal; at most ten times a second.
  void progress(double fraction, const std::string& what);

 private:
  void log(int level, const char* name, const std::string& message);
  void clear_bar();
  std::string remaining(double fraction) const;

  std::shared_ptr<spdlog::logger> logger_;
  ConsoleOptions options_;
  bool bar_shown_ = false;
  std::chrono::steady_clock::time_point last_bar_{}, begin_ = std::chrono::steady_clock::now();
};

}  // namespace pellicle::cli
