#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "command_tree.h"
#include "commands.h"
#include "pellicle/base/errors.h"

namespace pellicle::cli {

Run add_completion(CLI::App& app, const CLI::App& program) {
  auto shell = std::make_shared<std::string>("bash");
  app.add_option("SHELL", *shell, "bash")->capture_default_str();
  app.footer("Example: pellicle completion bash >~/.local/share/bash-completion/completions/pellicle");
  return [shell, &program](Console&) {
    if (*shell != "bash") throw SettingError("bad value", "SHELL", fmt::format("'{}' is not known; use bash", *shell));
    std::cout << bash_completion(program);
    return 0;
  };
}

Run add_manual(CLI::App& app, const CLI::App& program) {
  auto name = std::make_shared<std::string>();
  app.add_option("COMMAND", *name, "one of the commands; without it the page of the program");
  app.footer("Example: pellicle manual segment | man -l -");
  return [name, &program](Console&) {
    const CLI::App* command = nullptr;
    for (const auto* one : program.get_subcommands([](const CLI::App*) { return true; })) {
      if (one->get_name() == *name) command = one;
    }
    if (command == nullptr && !name->empty()) {
      throw SettingError("bad value", "COMMAND", fmt::format("'{}' is not a command; see 'pellicle --help'", *name));
    }
    std::cout << manual_page(program, command);
    return 0;
  };
}

}  // namespace pellicle::cli
