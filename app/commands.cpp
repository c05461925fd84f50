#include "commands.hpp"

#include "base/error.hpp"
#include "check.hpp"
#include "deck.hpp"
#include "deck/shape.hpp"
#include "output/hdf5_file.hpp"
#include "run.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>

namespace amontons {

namespace {

bool is_petsc_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1]));
}

bool is_petsc_value(const std::string& word) {
  if (word.ends_with(".yaml") || word.ends_with(".yml")) return false;
  return word.size() < 2 || word[0] != '-' || (word[1] != '-' && !is_petsc_option(word));
}

struct CommandLine {
  RunArguments run;
  std::string checked_deck;
  std::string key;
  bool check = false, schema = false, describe = false;
};

void declare(CLI::App& app, CommandLine& line) {
  app.set_help_flag("--help", "Show this text; -help shows PETSc's options as well");
  app.set_version_flag("--version", "amontons " AMONTONS_VERSION);
  app.add_option("DECK", line.run.deck, "Deck to run (.yaml)")->type_name("");
  app.add_option("--out", line.run.out, "Folder for the results instead of the deck's")->type_name("DIR");
  app.add_option("--restart", line.run.restart, "Go on from this checkpoint")->type_name("FILE");
  app.require_subcommand(0, 1);
  auto* check = app.add_subcommand("check", "Check deck and mesh without solving; show effects, unknowns, memory");
  check->add_option("DECK", line.checked_deck, "Deck to check")->type_name("")->required();
  auto* schema = app.add_subcommand("schema", "Print the JSON Schema of decks, for editors");
  auto* describe = app.add_subcommand("describe", "Manual page of a deck key, or an overview of all keys");
  describe->add_option("KEY", line.key, "Key with dots, such as contact.enforce.uzawa.alpha")->type_name("");
  // Never parsed here: main hands it over.
  app.add_subcommand("plan", "Propose mesh, increments and formulation for an error; `amontons plan --help`");
  for (auto* command : {check, schema, describe})
    command->set_help_flag("--help", "Show this text");
  check->callback([&line] { line.check = true; });
  schema->callback([&line] { line.schema = true; });
  describe->callback([&line] { line.describe = true; });
  app.footer("Options with a single dash are PETSc's: amontons deck.yaml -snes_monitor -ksp_type gmres\n"
             "Exit status: 0 solved and certified, 2 wrong deck, mesh or command line, 3 not converged,\n"
             "4 converged but not certified, 5 interrupted (checkpoint written).");
}

void check_run_arguments(const RunArguments& arguments) {
  std::vector<std::string> messages;
  std::error_code ignored;
  if (arguments.out && arguments.out->empty())
    messages.push_back("--out: the name is empty. Give a folder.");
  else if (arguments.out && std::filesystem::exists(*arguments.out, ignored) &&
           !std::filesystem::is_directory(*arguments.out, ignored))
    messages.push_back("--out: '" + *arguments.out + "' is a file. Give a folder.");
  if (arguments.restart && !std::filesystem::is_regular_file(*arguments.restart, ignored))
    messages.push_back("--restart: there is no file '" + *arguments.restart +
                       "'. Give the checkpoint.h5 of an earlier run.");
  if (!messages.empty()) throw UserError(std::move(messages));
}

int carry_out(MPI_Comm comm, const CommandLine& line, bool is_root, bool petsc_help) {
  if (line.check) {
    const auto report = check_report(comm, line.checked_deck);
    if (is_root) std::cout << report;
    return 0;
  }
  if (line.schema) {
    if (is_root) std::cout << json_schema(deck_shape(), "Amontons deck");
    return 0;
  }
  if (line.describe) {
    const auto page = line.key.empty() ? manual_overview(deck_shape()) : manual_page(deck_shape(), line.key);
    if (is_root) std::cout << page;
    return 0;
  }
  if (line.run.deck.empty()) {
    if (petsc_help) return 0; // PETSc has shown its options
    throw UserError("no deck is given. `amontons --help` shows how to call the program.");
  }
  on_root(comm, [&] {
    check_run_arguments(line.run);
    const auto command = nearest_match(line.run.deck, {"check", "schema", "describe", "plan"});
    if (!command.empty() && !std::filesystem::exists(line.run.deck))
      throw UserError("'" + line.run.deck + "' is neither a deck nor a command. Did you mean '" + command + "'?");
  });
  return run(comm, line.run);
}

} // namespace

SplitArguments split_arguments(const std::vector<std::string>& words) {
  SplitArguments split;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "-h") {
      split.own.push_back("--help");
    } else if (is_petsc_option(words[i])) {
      split.petsc.push_back(words[i]);
      if (i + 1 < words.size() && is_petsc_value(words[i + 1])) split.petsc.push_back(words[++i]);
    } else {
      split.own.push_back(words[i]);
    }
  }
  return split;
}

int run_command(MPI_Comm comm, const SplitArguments& arguments) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  CommandLine line;
  CLI::App app("Contact between deformable solids by finite elements", "amontons");
  declare(app, line);
  try {
    auto words = arguments.own;
    std::reverse(words.begin(), words.end()); // CLI11 takes them from the back
    app.parse(std::move(words));
    const auto& petsc = arguments.petsc;
    return carry_out(comm, line, rank == 0, std::find(petsc.begin(), petsc.end(), "-help") != petsc.end());
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      if (rank == 0) app.exit(error);
      return 0;
    }
    if (rank == 0)
      std::cerr << "error: " << error.what() << ". `amontons --help` shows how to call the program." << std::endl;
    return status_wrong_input;
  } catch (const UserError& error) {
    if (rank == 0)
      for (const auto& message : error.messages())
        std::cerr << "error: " << message << std::endl;
    if (has_stuck_hdf5_file()) MPI_Abort(comm, status_wrong_input);
    return status_wrong_input;
  }
}

} // namespace amontons
