#include "tools/command/manual.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <memory>

#include "tools/odolessd/command_line.hpp"

namespace odoless {
namespace {

constexpr const char* kEnd = R"(.SH EXIT STATUS
0, or one of sysexits.h with the reason on standard error: 64 wrong arguments, 65 wrong data, 66 no such file, 69 no such
device, 70 a fault of the program, 73 or 74 a file that cannot be written, 77 no permission, 78 a wrong configuration.
.SH FILES
.TP
.I /etc/odoless/robot.toml
The configuration of the daemon as a service. "odoless config defaults" writes one to begin with.
.TP
.I /var/lib/odoless
What the service saves.
.TP
.I /usr/share/odoless
Examples of configurations and worlds, and the types of the LCM messages.
.SH SEE ALSO
.BR odoless (1),
.BR odolessd (8)
)";

/// Text as roff takes it for text.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string in_capitals(std::string text) {
  for (char& c : text) {
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return text;
}

std::string text_of(const CLI::Option& option) {
  const bool positional = option.get_positional();
  std::string out = ".TP\n\\fB" + escaped(option.get_name(positional, true)) + "\\fR";
  if (!positional && option.get_expected_max() != 0) {
    out += " \\fI" + escaped(option.get_type_name()) + "\\fR";
  }
  out += "\n" + escaped(option.get_description());
  if (!option.get_default_str().empty()) {
    out += escaped(" (default: " + option.get_default_str() + ")");
  }
  return out + (option.get_required() ? " (required)\n" : "\n");
}

std::string options_of(const CLI::App& command) {
  std::string out;
  for (const CLI::Option* const option : command.get_options()) {
    const std::string name = option->get_name(false, true);
    if (name != "-h,--help" && name != "--help-all") {
      out += text_of(*option);
    }
  }
  return out;
}

/// The commands below `command`, which is called `path`, each with its options.
std::string commands_of(const CLI::App& command, const std::string& path) {
  std::string out;
  for (const CLI::App* const inner : command.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string name = path + " " + inner->get_name();
    out += fmt::format(".SS {}\n{}\n{}", escaped(name), escaped(inner->get_description()), options_of(*inner)) +
           commands_of(*inner, name);
  }
  return out;
}

}  // namespace

std::string manual_page(const CLI::App& program, int section) {
  const std::string name = program.get_name();
  const std::string commands = commands_of(program, name);
  return fmt::format(".TH {} {} \"\" \"odoless " ODOLESS_VERSION "\"\n", in_capitals(name), section) +
         fmt::format(".SH NAME\n{} \\- {}\n", name, escaped(program.get_description())) +
         fmt::format(".SH SYNOPSIS\n.B {}\n{}[options]\n", name, commands.empty() ? "" : "command ") +
         ".SH OPTIONS\n.TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nPrint the help; of each command too, and with "
         "\\-\\-help\\-all of all at once\n" +
         options_of(program) + (commands.empty() ? "" : ".SH COMMANDS\n" + commands) + kEnd;
}

void add_manual(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("manual", "Print the manual page, for `man -l -`");
  const auto program = std::make_shared<std::string>("odoless");
  command->add_option("program", *program, "odoless or odolessd")
      ->check(CLI::IsMember({"odoless", "odolessd"}))
      ->capture_default_str();
  command->callback([&app, program] {
    if (*program == "odoless") {
      fmt::print("{}", manual_page(app, 1));
    } else {
      describe_odolessd([](const CLI::App& daemon) { fmt::print("{}", manual_page(daemon, 8)); });
    }
  });
}

}  // namespace odoless
