#pragma once
/// One function per subcommand: it declares the flags and returns what runs once they are parsed.

#include <string>
#include <vector>

#include "command_flags.h"

namespace CLI {
class App;
}

namespace pellicle::cli {

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

}  // namespace pellicle::cli
