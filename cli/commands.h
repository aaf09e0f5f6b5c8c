#pragma once
/// One function a subcommand: it declares the flags and returns what runs when they are parsed.

#include <functional>
#include <string>
#include <vector>

#include "console.h"
#include "pellicle/batch/manifest.h"

namespace CLI {
class App;
}

namespace pellicle {
struct SettingKey;
}

namespace pellicle::cli {

/// Returns the exit code; throws pellicle::Error.
using Run = std::function<int(Console&)>;

Run add_segment(CLI::App& app, const std::vector<std::string>& command_line);
Run add_phantom(CLI::App& app);
Run add_evaluate(CLI::App& app);
Run add_export(CLI::App& app);
Run add_fit(CLI::App& app, const std::vector<std::string>& command_line);
Run add_morph(CLI::App& app, const std::vector<std::string>& command_line);
Run add_info(CLI::App& app);
Run add_batch(CLI::App& app);
Run add_bids(CLI::App& app);
Run add_report(CLI::App& app);
/// These describe `program`, the app above theirs, as it is when they run.
Run add_completion(CLI::App& app, const CLI::App& program);
Run add_manual(CLI::App& app, const CLI::App& program);

/// Flags that every subcommand has: -q, -v, --log-json, --no-progress.
ConsoleOptions* add_console_flags(CLI::App& app);

/// The flag of one setting of `segment`; the words that follow it go to `values`, which must live as long as the app.
void add_setting_flag(CLI::App& app, const SettingKey& key, std::vector<std::string>& values);

/// Flags of `segment` that hold for every case of a batch; `typed` must live as long as the app.
void add_common_setting_flags(CLI::App& app, std::vector<std::vector<std::string>>& typed);
/// What was typed after them, checked, and the settings file unless it is empty. \throws UsageError.
FlagValues common_values(const std::vector<std::vector<std::string>>& typed, const std::string& config);

/// "1,2,3" as three numbers; one number stands for all three. \throws UsageError naming `where`.
std::vector<double> three_numbers(const std::string& text, const std::string& where);

}  // namespace pellicle::cli
