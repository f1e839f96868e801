// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <memory>

#include "commands.h"
#include "interrupt.h"
#include "render_arguments.h"
#include "scene_run.h"

namespace vrc {
namespace {

int run_records(const RenderArguments& arguments, const std::string& command_line) {
  const PhaseTimer total("total");
  check_records_arguments(arguments);
  const InterruptGuard interrupt;
  SceneRun run = run_scene(arguments, command_line, interrupt.flag(), [&](const SceneDescription& scene) {
    if (render_options_for(arguments, scene).bounces == 0) {
      throw InputError("without indirect light there are no records; give --bounces 1 or more");
    }
  });
  const PhaseTimer writing("write files");
  OutputErrors errors;
  write_record_files(arguments, run.result, errors);
  errors.rethrow_first();
  return finish_run(arguments, run, writing, total);
}

}  // namespace

CommandAction add_records_command(CLI::App& program, const std::string& command_line) {
  CLI::App* command = program.add_subcommand("records", "Place the cache's records and export them");
  const auto arguments = std::make_shared<RenderArguments>();
  declare_records_options(*command, *arguments);
  return [arguments, command_line] {
    arguments->render.shade = arguments->record_overlay.has_value();
    return run_records(*arguments, command_line);
  };
}

}  // namespace vrc
