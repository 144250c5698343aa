#include "tools/command/completion.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "tools/odolessd/command_line.hpp"

namespace odoless {
namespace {

std::string words_of(const CLI::App& command) {
  std::string words;
  for (const CLI::App* const inner : command.get_subcommands([](const CLI::App*) { return true; })) {
    words += inner->get_name() + " ";
  }
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      words += "--" + name + " ";
    }
  }
  words.pop_back();  // every command has --help
  return words;
}

/// One branch of the shell's `case` for each command: its path, and the words that can follow.
std::string branches_of(const CLI::App& command, const std::string& path) {
  std::string out = fmt::format("    '{}') candidates='{}' ;;\n", path, words_of(command));
  for (const CLI::App* const inner : command.get_subcommands([](const CLI::App*) { return true; })) {
    out += branches_of(*inner, path + " " + inner->get_name());
  }
  return out;
}

/// The shell's function that sets `candidates`: `path` goes down one command for each word that is one.
std::string words_function(const CLI::App& program) {
  const std::string name = program.get_name();
  return fmt::format(
             "_{0}_words() {{\n"
             "  case $1 in\n",
             name) +
         branches_of(program, name) +
         "    *) return 1 ;;\n"
         "  esac\n"
         "}\n";
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  return words_function(program) + fmt::format(R"(_{0}() {{
  local candidates path={0} word
  _{0}_words "$path"
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    _{0}_words "$path $word" && path="$path $word"
  done
  mapfile -t COMPREPLY < <(compgen -W "$candidates" -- "${{COMP_WORDS[COMP_CWORD]}}")
}}
complete -o default -F _{0} {0}
)",
                                               program.get_name());
}

std::string zsh_completion(const CLI::App& program) {
  return words_function(program) + fmt::format(R"(_{0}() {{
  local candidates path_of_command={0} word
  _{0}_words "$path_of_command"
  for word in "${{(@)words[2,CURRENT-1]}}"; do
    _{0}_words "$path_of_command $word" && path_of_command="$path_of_command $word"
  done
  compadd -- ${{=candidates}} || _files
}}
compdef _{0} {0}
)",
                                               program.get_name());
}

void add_completion(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("completion", "Print what makes a shell complete commands and options");
  const auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
  command->callback([&app, shell] {
    const auto print = [&](const CLI::App& program) {
      fmt::print("{}", *shell == "bash" ? bash_completion(program) : zsh_completion(program));
    };
    fmt::print("{}", *shell == "zsh" ? "#compdef odoless odolessd\n" : "");
    print(app);
    describe_odolessd(print);
    // Loaded by itself at the first need of it, the file is that need's answer, too.
    fmt::print("{}", *shell == "zsh" ? "[[ -z $service ]] || _$service\n" : "");
  });
}

}  // namespace odoless
