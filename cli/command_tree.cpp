#include "command_tree.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <vector>

#include "pellicle/output/provenance.h"

namespace pellicle::cli {

namespace {

using Options = std::vector<const CLI::Option*>;

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

// Flags that the help shows.
Options flags_of(const CLI::App& app) {
  Options flags = app.get_options(
      [](const CLI::Option* option) { return !option->get_positional() && !option->get_group().empty(); });
  return flags;
}

std::vector<std::string> spellings(const CLI::Option& flag) {
  std::vector<std::string> words;
  for (const auto& name : flag.get_snames()) words.push_back("-" + name);
  for (const auto& name : flag.get_lnames()) words.push_back("--" + name);
  return words;
}

bool takes_value(const CLI::Option& flag) {
  return flag.get_items_expected_max() > 0;
}

// "auto|bright|dark" -> "auto bright dark"; empty when the flag takes no such words.
std::string choices(const CLI::Option& flag) {
  std::string words = flag.get_type_name();
  if (words.find('|') == std::string::npos) return {};
  std::replace(words.begin(), words.end(), '|', ' ');
  return words;
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

// Text for troff: dashes that stay dashes, no line that starts like a request.
std::string troff(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool line_start = i == 0 || text[i - 1] == '\n';
    if (line_start && (text[i] == '.' || text[i] == '\'')) out += "\\&";
    if (text[i] == '\\') {
      out += "\\e";
    } else if (text[i] == '-') {
      out += "\\-";
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string manual_name(const CLI::App& program, const CLI::App* command) {
  return command == nullptr ? program.get_name() : program.get_name() + "-" + command->get_name();
}

std::string manual_flag(const CLI::Option& flag) {
  std::vector<std::string> words;
  for (const auto& word : spellings(flag)) words.push_back("\\fB" + troff(word) + "\\fR");
  std::string text = ".TP\n" + joined(words, ", ");
  if (takes_value(flag) && !flag.get_type_name().empty()) text += " \\fI" + troff(flag.get_type_name()) + "\\fR";
  text += "\n" + troff(flag.get_description());
  if (takes_value(flag) && !flag.get_default_str().empty()) {
    text += fmt::format(" (default: {})", troff(flag.get_default_str()));
  }
  return text + "\n";
}

std::string manual_flags(const CLI::App& app) {
  std::vector<std::string> groups;
  const Options flags = flags_of(app);
  for (const auto* flag : flags) {
    if (std::find(groups.begin(), groups.end(), flag->get_group()) == groups.end()) groups.push_back(flag->get_group());
  }
  std::string text;
  for (const auto& group : groups) {
    text += fmt::format(".SS {}\n", troff(group));
    for (const auto* flag : flags) {
      if (flag->get_group() == group) text += manual_flag(*flag);
    }
  }
  return text;
}

// Lines as they stand.
std::string verbatim(const std::string& text) {
  return ".nf\n" + troff(text) + "\n.fi\n";
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  const std::string& name = program.get_name();
  std::string commands, cases;
  for (const auto* command : commands_of(program)) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    std::string words, values;
    for (const auto* flag : flags_of(*command)) {
      words += " " + joined(spellings(*flag), " ");
      if (choices(*flag).empty()) continue;
      values += fmt::format("        {}) words=\"{}\" ;;\n", joined(spellings(*flag), "|"), choices(*flag));
    }
    cases += fmt::format("    {})\n      flags=\"{}\"\n      case \"$before\" in\n{}      esac\n      ;;\n",
                         command->get_name(), words.substr(words.empty() ? 0 : 1), values);
  }
  return fmt::format(R"(# bash completion for {0}
_{0}() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" flags="" words=""
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{1} --help --version" -- "$current"))
    return
  fi
  case "${{COMP_WORDS[1]}}" in
{2}  esac
  if [ -n "$words" ]; then
    COMPREPLY=($(compgen -W "$words" -- "$current"))
  elif [[ "$current" == -* ]]; then
    COMPREPLY=($(compgen -W "$flags" -- "$current"))
  fi
}}
complete -o bashdefault -o default -F _{0} {0}
)",
                     name, commands, cases);
}

std::string manual_page(const CLI::App& program, const CLI::App* command) {
  const CLI::App& app = command == nullptr ? program : *command;
  const std::string name = manual_name(program, command);
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
  std::string text = fmt::format(".TH {} 1 \"\" \"pellicle {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n", troff(upper),
                                 program_version(), troff(name), troff(app.get_description()));
  text += fmt::format(".SH SYNOPSIS\n.B {}", program.get_name());
  if (command == nullptr) {
    text += "\n.I COMMAND\n[\\fIflags\\fR]\n.SH COMMANDS\n";
    for (const auto* one : commands_of(program)) {
      text += fmt::format(".TP\n.BR {} (1)\n{}\n", troff(manual_name(program, one)), troff(one->get_description()));
    }
  } else {
    text += fmt::format(" {}\n[\\fIflags\\fR]", command->get_name());
    std::string places;
    for (const auto* option : app.get_options([](const CLI::Option* o) { return o->get_positional(); })) {
      text += fmt::format(" \\fI{}\\fR", troff(option->get_name(true)));
      places += fmt::format(".TP\n\\fI{}\\fR\n{}\n", troff(option->get_name(true)), troff(option->get_description()));
    }
    text += "\n";
    if (!places.empty()) text += ".SH ARGUMENTS\n" + places;
  }
  text += ".SH OPTIONS\n" + manual_flags(app);
  if (!app.get_footer().empty()) text += ".SH NOTES\n" + verbatim(app.get_footer());
  if (command != nullptr) {
    text += ".SH EXIT STATUS\n" + verbatim(program.get_footer());
    text += fmt::format(".SH SEE ALSO\n.BR {} (1)\n", program.get_name());
  }
  return text;
}

}  // namespace pellicle::cli
