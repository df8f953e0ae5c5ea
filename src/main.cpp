// The command line: options to commands, errors to exit codes. The only unit of the program that sees CLI11.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "commands/chart_stability.h"
#include "commands/check_scene.h"
#include "commands/compare.h"
#include "commands/export_trajectory.h"
#include "commands/film.h"
#include "commands/inspect_mesh.h"
#include "commands/pick_point.h"
#include "commands/pictures.h"
#include "commands/plan_scene.h"
#include "commands/plot_runs.h"
#include "commands/sample_scenes.h"
#include "commands/simulate_scene.h"
#include "commands/study_scenes.h"
#include "commands/submit.h"
#include "commands/verify_truth.h"
#include "commands/warnings.h"
#include "core/console.h"
#include "core/crash.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/printable.h"
#include "scene/suggestion.h"
#include "study/study_method.h"

namespace cradle {
namespace {

constexpr const char* kAbout = "Cradle: rigid-body physics from a scene file, and pictures of it.";
constexpr int kExitOfSignal = 128;  // and its number, as shells have it

/// Everything that the command line can say, and the command that it asks for.
struct CommandLine {
  std::string input, output, expected, actual, pixel;
  std::vector<std::string> scenes, methods, maps;
  SimulateOptions simulation;
  PictureOptions pictures;
  CompareOptions comparison;
  ExportOptions exported;
  PlotOptions plot;
  SampleOptions sampling;
  SubmitOptions submission;
  InspectOptions inspection;
  long frame = 0;
  bool json = false, quiet = false, sideBySide = false;
  std::function<void()> command;
};

CLI::App* addCommand(CLI::App& app, CommandLine& line, const char* name, const char* description, const char* example,
                     std::function<void()> run) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer(fmt::format("Example:\n  {}", example));
  command->callback([&line, run = std::move(run)] { line.command = run; });
  return command;
}

void addOutput(CLI::App* command, CommandLine& line, const char* what) {
  command->add_option("-o,--output", line.output, what)->required();
}

void addAssetRoot(CLI::App* command, std::string& assetRoot) {
  command->add_option("--asset-root", assetRoot, "folder that the scene's meshes must be below (default: anywhere)");
}

void addPictureOptions(CLI::App* command, CommandLine& line) {
  command->add_option("--size", line.pictures.size, "WIDTHxHEIGHT in pixels (default: the scene's)");
  command->add_option("--overlay", line.pictures.overlay,
                      "what lies on the pictures, with commas: time, contacts, velocities, trails, plot=energy, "
                      "plot=energyError, plot=height:BODY");
  command->add_option("--shaders", line.pictures.shaders, "folder with shaders to use instead of the built-in ones");
  addAssetRoot(command, line.pictures.assetRoot);
}

void addOverrides(CLI::App* command, CommandLine& line) {
  command->add_option("--accuracy", line.simulation.scene.accuracy,
                      "in place of the scene's: 1e-12 to 1e-2, visual, default or reference");
  command->add_option("--method", line.simulation.scene.method, "explicitEuler, semiImplicitEuler, rk4 or dop853");
  command->add_option("--time-step", line.simulation.scene.timeStep, "step of --method in s; dop853 needs none");
  command->add_option("--duration", line.simulation.scene.duration, "in place of the scene's duration, in s");
  addAssetRoot(command, line.simulation.scene.assetRoot);
}

void addSimulate(CLI::App& app, CommandLine& line) {
  auto* simulate = addCommand(app, line, "simulate", "Simulate a scene into a trajectory file",
                              "cradle simulate scenes/newtons_cradle.json -o cradle.sqlite\n"
                              "  cradle simulate scenes/newtons_cradle.json -o cradle.sqlite --strict\n"
                              "  cradle simulate stiff.json -o blow_up.sqlite --method explicitEuler --until-it-fails",
                              [&] { simulateScene(line.input, line.output, line.simulation, line.quiet); });
  simulate->add_option("scene", line.input, "scene file (JSON)")->required();
  addOutput(simulate, line, "trajectory file to write");
  addOverrides(simulate, line);
  simulate->add_flag("--strict", line.simulation.isStrict,
                     "end with exit code 7 at the first thing that is not as the plan says: a promise given up, a "
                     "correction of the motion, bodies too deep in each other");
  simulate
      ->add_flag(
          "--until-it-fails", line.simulation.untilItFails,
          "where the run becomes unstable, keep the frames before that as a whole trajectory, to film the failure")
      ->excludes("--strict");
  simulate->add_flag("--fresh", line.simulation.isFresh,
                     "begin anew, where FILE.part of a run that was ended would be gone on with");
  simulate->add_flag("--check-accuracy", line.simulation.checksAccuracy,
                     "run again, finer, and print the error of each body; where the scene is chaotic, say so");

  auto* plan =
      addCommand(app, line, "plan", "Say how a scene would be simulated, why, what is promised, and what is left out",
                 "cradle plan scenes/spinning_handle.json\n  cradle plan scenes/arch.json --json",
                 [&] { printPlan(line.input, line.simulation.scene, line.json); });
  plan->add_option("scene", line.input, "scene file (JSON)")->required();
  addOverrides(plan, line);
  plan->add_flag("--json", line.json, "print JSON");
}

/// With commas between them.
template <class Named>
std::string namesOf(const std::vector<Named>& all) {
  std::string names;
  for (const Named& one : all) names += (names.empty() ? "" : ", ") + one.name;
  return names;
}

void addStudy(CLI::App& app, CommandLine& line) {
  auto* study = addCommand(
      app, line, "study", "Chart error against cost of all methods on scenes, with study.csv",
      "cradle study scenes/suspended_model.json scenes/rod_pendulum.json -o study",
      [&] { studyScenes(line.scenes, line.simulation.scene.assetRoot, line.output, line.methods, line.quiet); });
  study->add_option("scenes", line.scenes, "scene files (JSON)")->required();
  addOutput(study, line, "folder for study.csv and charts (SVG, PNG)");
  addAssetRoot(study, line.simulation.scene.assetRoot);
  study->add_option("--methods", line.methods, "of " + namesOf(studyMethods()))
      ->delimiter(',')
      ->allow_extra_args(false);

  auto* stability = addCommand(app, line, "stability", "Map where methods hold and where they fail, with charts",
                               "cradle stability -o maps --maps step_stiffness,logistic",
                               [&] { chartStability(line.output, line.maps, line.quiet); });
  addOutput(stability, line, "folder for the maps (CSV, SVG, PNG)");
  stability->add_option("--maps", line.maps, "of " + namesOf(stabilityMaps()))->delimiter(',')->allow_extra_args(false);
}

void addPlot(CLI::App& app, CommandLine& line) {
  auto* plot = addCommand(app, line, "plot", "Chart quantities of runs over time",
                          "cradle plot a.sqlite b.sqlite -o heights.svg --quantity height:ball\n"
                          "  cradle plot scenes/rod_pendulum.json -o methods.png --methods explicitEuler,rk4,plan "
                          "--time-step 0.01 --quantity energyError,phase:single",
                          [&] {
                            line.plot.scene = line.simulation.scene;
                            line.plot.methods = line.methods;
                            plotRuns(line.scenes, line.output, line.plot, line.quiet);
                          });
  plot->add_option("runs", line.scenes, "trajectories, or scene files, which are simulated")->required();
  addOutput(plot, line, "chart to write (.svg or .png)");
  plot->add_option("--quantity", line.plot.quantities,
                   "what is shown, a panel each, with commas, or several times: energy, energyError, height:BODY, "
                   "angle:BODY or angle:JOINT (of a pendulum), phase:BODY or phase:JOINT (its velocity over it), "
                   "error, error:BODY (against --reference)")
      ->allow_extra_args(false)
      ->capture_default_str();
  plot->add_option("--reference", line.plot.reference, "trajectory or scene that errors are measured against");
  plot->add_option("--methods", line.methods,
                   "each scene is simulated by each: explicitEuler, semiImplicitEuler, rk4, dop853, or plan, the "
                   "scene's own (default)")
      ->delimiter(',')
      ->allow_extra_args(false);
  plot->add_option("--time-step", line.simulation.scene.timeStep, "step of those methods in s");
  plot->add_option("--accuracy", line.simulation.scene.accuracy, "in place of the scenes'");
  plot->add_option("--duration", line.simulation.scene.duration, "in place of the scenes' durations, in s");
  addAssetRoot(plot, line.simulation.scene.assetRoot);
}

/// Of a command that takes more with an option alone.
void requireOneInput(const std::vector<std::string>& inputs) {
  if (inputs.size() == 1) return;
  throw Error(ErrorKind::usage, inputs[1],
              "is one name too many for video; several films beside each other are --side-by-side");
}

void addPictures(CLI::App& app, CommandLine& line) {
  auto* render = addCommand(app, line, "render", "Draw the frames of a scene or trajectory as PNG files",
                            "cradle render scenes/newtons_cradle.json -o frames --frames 0:60",
                            [&] { renderFrames(line.input, line.output, line.pictures, line.quiet); });
  render->add_option("input", line.input, "scene or trajectory file")->required();
  addOutput(render, line, "folder for frame_000000.png, ...");
  render->add_option("--frames", line.pictures.frames,
                     "FIRST:END, half-open, FIRST:, :END or one frame (default: all pictures; the state at the "
                     "duration is none of them, but may be named)");
  render->add_option("--passes", line.pictures.passes,
                     "what is written of each frame, with commas: rgb (default), depth, normal, segmentation, flow, "
                     "backwardFlow, objectCoordinates, or all");
  render
      ->add_option("--pass-format", line.pictures.passFormat,
                   "npy: a NumPy file of each pass; exr: an OpenEXR file of each frame, with a layer of each pass")
      ->capture_default_str();
  render->add_option("--shard", line.pictures.shard, "PART/PARTS: one of so many parts of the frames, from 1/PARTS on");
  render->add_flag("--skip-existing", line.pictures.skipExisting,
                   "leave frames as they are that are in the folder already");
  render->add_flag("--overwrite", line.pictures.overwrite, "replace frames that are in the folder already");
  addPictureOptions(render, line);

  auto* pick = addCommand(app, line, "pick", "Say what a pixel of a picture shows, to push or anchor it there",
                          "cradle pick scenes/newtons_cradle.json --frame 0 640,360",
                          [&] { pickPoint(line.input, line.frame, line.pixel, line.pictures, line.quiet); });
  pick->add_option("input", line.input, "scene or trajectory file")->required();
  pick->add_option("pixel", line.pixel, "COLUMN,ROW from the upper left pixel")->required();
  pick->add_option("--frame", line.frame, "number of the frame")->capture_default_str();
  pick->add_option("--size", line.pictures.size, "WIDTHxHEIGHT in pixels (default: the scene's)");
  addAssetRoot(pick, line.pictures.assetRoot);

  auto* verify = addCommand(
      app, line, "verify", "Check ground truth that render --passes wrote against its trajectory (exit 9: wrong)",
      "cradle verify truth\n"
      "  cradle render scenes/newtons_cradle.json -o truth --passes all && cradle verify truth --json",
      [&] { verifyTruth(line.input, line.json, line.quiet); });
  verify->add_option("folder", line.input, "folder that `cradle render --passes` filled")->required();
  verify->add_flag("--json", line.json, "print JSON");

  auto* encode =
      addCommand(app, line, "encode", "Make a film of a folder of frames", "cradle encode frames -o film.mp4",
                 [&] { encodeFrames(line.input, line.output, line.pictures.framesPerSecond, line.quiet); });
  encode->add_option("folder", line.input, "folder with frame_000000.png, ...")->required();
  addOutput(encode, line, "film to write (.mp4, .mov, .mkv, .gif)");
  encode->add_option("--frames-per-second", line.pictures.framesPerSecond, "of the film")->capture_default_str();

  auto* video = addCommand(app, line, "video", "Make a film of a scene or trajectory",
                           "cradle video scenes/newtons_cradle.json -o cradle.mp4\n"
                           "  cradle video euler.sqlite rk4.sqlite -o both.mp4 --side-by-side",
                           [&] {
                             if (line.sideBySide)
                               return makeSideBySideFilm(line.scenes, line.output, line.pictures, line.quiet);
                             requireOneInput(line.scenes);
                             makeFilm(line.scenes[0], line.output, line.pictures, line.quiet);
                           });
  video->add_option("input", line.scenes, "scene or trajectory file")->required();
  addOutput(video, line, "film to write (.mp4, .mov, .mkv, .gif)");
  video->add_flag("--side-by-side", line.sideBySide,
                  "two to four scenes or trajectories beside each other, each below its method; --size is that of one");
  addPictureOptions(video, line);
}

void addSample(CLI::App& app, CommandLine& line) {
  auto* sample =
      addCommand(app, line, "sample", "Make scenes, trajectories and pictures of a scene with values to draw",
                 "cradle sample distributions/dropped_shapes.json -n 100 --seed 1 -o set --simulate\n"
                 "  cradle sample distributions/dropped_shapes.json -n 100 -o set --passes all --size 320x240 -j 2\n"
                 "  cradle sample distributions/two_dice.json -n 400 --chains 4 -j 2 -o sixes --simulate",
                 [&] { sampleScenes(line.input, line.output, line.sampling, line.pictures, line.quiet); });
  sample->add_option("scene", line.input, "scene file (JSON) with draws")->required();
  addOutput(sample, line, "folder for sample_000000/scene.json, ..., and index.json");
  sample->add_option("-n,--count", line.sampling.count, "number of samples")->capture_default_str();
  sample->add_option("--seed", line.sampling.seed, "whole number; another one gives other samples")
      ->capture_default_str();
  sample->add_flag("--simulate", line.sampling.simulates, "write the trajectory of each sample");
  sample->add_flag("--check-accuracy", line.sampling.findsHorizon,
                   "run each again, finer: the frame from which on its motion is one of many (horizon)");
  sample->add_flag("--render", line.sampling.renders, "draw the frames of each sample, into its folder");
  sample->add_option("--passes", line.pictures.passes, "draw these passes, as those of render; rgb is one of them");
  sample->add_option("--pass-format", line.pictures.passFormat, "npy or exr, as that of render")->capture_default_str();
  sample->add_option("--frames", line.pictures.frames, "FIRST:END, half-open: the frames to draw (default: all)");
  sample->add_option("--shard", line.sampling.shard,
                     "PART/PARTS: one of so many parts of the samples, or of the chains, from 1/PARTS on");
  sample->add_option("--chains", line.sampling.chains,
                     "Markov chains for the wishes of the scene, of which each state is a sample");
  sample->add_option("-j,--processes", line.sampling.processes, "samples, or chains, made beside each other")
      ->capture_default_str();
  sample
      ->add_option(
          "--format", line.sampling.format,
          "folder; or tar: the samples are packed into samples.tar, in WebDataset's form, and their folders go")
      ->capture_default_str();
  addPictureOptions(sample, line);
}

void addSubmit(CLI::App& app, CommandLine& line) {
  auto* submit =
      addCommand(app, line, "submit", "Do a long command in parts, as jobs of a scheduler",
                 "cradle submit local video scenes/newtons_cradle.json -o cradle.mp4\n"
                 "  cradle submit slurm --run sample distributions/dropped_shapes.json -n 10000 --passes all -o set",
                 [&] { submitCommand(line.submission, line.quiet); });
  submit
      ->add_option("scheduler", line.submission.scheduler,
                   "slurm, parallel (GNU parallel), or local: this machine alone")
      ->required();
  submit->add_flag("--run", line.submission.starts,
                   "start the jobs, too, which are written into OUTPUT.jobs (default: sh OUTPUT.jobs/run.sh does)");
  submit->footer(
      submit->get_footer() +
      "\nBehind the scheduler stands the command: simulate, render, video or sample, its input, and its options.");
  submit->fallthrough(false)->prefix_command();  // the words of a command are not ours
}

void addQuestions(CLI::App& app, CommandLine& line) {
  auto* inspect = addCommand(app, line, "inspect", "Say what the objects of a mesh file are as bodies of density 1",
                             "cradle inspect assets/l_prism.3ds", [&] { inspectMesh(line.input, line.inspection); });
  inspect->add_option("mesh", line.input, "mesh file (.3ds, .obj, .ply, .stl, .gltf, ...)")->required();
  inspect->add_option("--scale", line.inspection.scale, "file's units to metres")->capture_default_str();
  inspect->add_flag("--vertices", line.inspection.listsVertices, "list the vertices by the numbers that anchors have");
  inspect->add_option("--near", line.inspection.near, "with --vertices: X,Y,Z; the ten that are nearest to it")
      ->delimiter(',')
      ->allow_extra_args(false);
  inspect->add_flag("--json", line.inspection.asJson, "print JSON");

  auto* check = addCommand(app, line, "check", "Check a scene and its meshes without simulating",
                           "cradle check scenes/newtons_cradle.json\n  cradle check scenes/newtons_cradle.json --json",
                           [&] { checkScene(line.input, line.simulation.scene, line.json); });
  check->add_option("scene", line.input, "scene file (JSON)")->required();
  check->add_flag("--json", line.json, "print JSON");
  addAssetRoot(check, line.simulation.scene.assetRoot);

  auto* compare =
      addCommand(app, line, "compare", "Compare images, folders of images, or trajectories (exit 9: different)",
                 "cradle compare expected/ actual/ --report report.html --junit compare.xml\n"
                 "  cradle compare expected.sqlite actual.sqlite --json",
                 [&] { compareResults(line.expected, line.actual, line.comparison); });
  compare->add_option("expected", line.expected, "image, folder or trajectory")->required();
  compare->add_option("actual", line.actual, "the same kind")->required();
  compare->add_option(
      "--visible", line.comparison.visible,
      "for images, LEVEL:PERCENT: pixels in percent that may be off by more than that (default: 2:0.005, "
      "and 4 pixels in small ones)");
  compare->add_option("--striking", line.comparison.striking,
                      "the same for large differences (default: 32:0.001, and 1)");
  compare->add_option("--report", line.comparison.report, "page to write (.html): the pictures that differ, to swap");
  compare->add_option("--junit", line.comparison.junit,
                      "report to write (.xml), as services of continuous integration show it: a test case a picture");
  compare->add_flag("--json", line.comparison.asJson, "print JSON");
  compare->add_option("--tolerance", line.comparison.tolerance, "for trajectories: max |x-x_ref|/(1+|x_ref|)")
      ->capture_default_str();

  auto* exported =
      addCommand(app, line, "export", "Write a trajectory as a table, a model that moves, or a page that plays it",
                 "cradle export cradle.sqlite -o cradle.csv\n  cradle export cradle.sqlite -o cradle.glb\n"
                 "  cradle export cradle.sqlite -o cradle.html",
                 [&] { exportTrajectory(line.input, line.output, line.exported, line.quiet); });
  exported->add_option("trajectory", line.input, "trajectory file")->required();
  addOutput(
      exported, line,
      ".csv: a table of states; .glb: glTF 2.0, moving in simulated time, with camera and lights, joints with their "
      "bodies, springs, rods and ropes drawn straight, without pushes; .html: a page to walk around in, with curves, "
      "events and forces, which needs nothing else");
  exported->add_flag("--contacts", line.exported.ofContacts,
                     "the .csv is of contacts that last, with their forces, in place of states");
  exported->add_option("--with", line.exported.other,
                       "another trajectory of the same bodies, which the .html shows over the first one, in red");
}

/// Says what was found where CLI11 would say only that it could not be converted, or take it for a value that is not
/// there.
void checkValues(CLI::App& app) {
  const CLI::Validator isNumber(
      [](const std::string& text) {
        double number = 0;
        const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool isWhole = end == text.data() + text.size() && fault != std::errc::invalid_argument;
        return isWhole ? "" : fmt::format("found \"{}\"; allowed are numbers, as 0.5 or 1e-3", printableLine(text));
      },
      "");
  const CLI::Validator isSomething(
      [](const std::string& text) { return text.empty() ? "is empty; give a value, or leave the option out" : ""; },
      "");
  for (CLI::App* command : app.get_subcommands({}))
    for (CLI::Option* option : command->get_options()) {
      const bool saysSoItself = option->get_positional() || option->check_lname("output");  // in its own words
      if (option->get_type_name() == "FLOAT") option->check(isNumber);
      if (option->get_type_name() == "TEXT" && !saysSoItself) option->check(isSomething);
    }
}

[[noreturn]] void refuseOption(const std::string& word, const CLI::App& app, const CLI::App& command) {
  const std::string name = word.substr(0, word.find('='));
  std::vector<std::string> names;
  for (const CLI::App* of : {&command, &app})
    for (const CLI::Option* option : of->get_options())
      for (const std::string& known : option->get_lnames()) names.push_back("--" + known);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  throw Error(ErrorKind::usage, name,
              fmt::format("unknown option; allowed are {}{}", fmt::join(names, ", "), didYouMean(name, names)));
}

/// Names the first word that nothing was known to do with.
void refuseUnknownWord(const CLI::App& app) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  if (!parsed.empty() && parsed[0]->get_prefix_command()) return;  // its words are those of a command
  std::vector<std::string> words = app.remaining(true);
  const auto option = std::find_if(words.begin(), words.end(), [](const auto& word) { return word.starts_with("-"); });
  if (!parsed.empty() && option != words.end()) refuseOption(*option, app, *parsed[0]);
  if (words.empty()) return;
  if (!parsed.empty())
    throw Error(ErrorKind::usage, words.back(), fmt::format("is one name too many for {}", parsed[0]->get_name()));
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
  if (words[0].starts_with('-'))
    throw Error(
        ErrorKind::usage, words[0],
        fmt::format("is no option of the program itself; a command comes first: {}", fmt::join(commands, ", ")));
  throw Error(
      ErrorKind::usage, words[0].empty() ? "\"\"" : words[0],
      fmt::format("is no command; allowed are {}{}", fmt::join(commands, ", "), didYouMean(words[0], commands)));
}

/// Help, the version, or what is wrong with the command line.
int answer(const CLI::App& app, const CLI::ParseError& error) {
  std::ostringstream output, faults;
  const int code = app.exit(error, output, faults);
  showText(stderr, faults.str());
  showText(stdout, output.str());
  flushOutput();
  return code == 0 ? 0 : static_cast<int>(ErrorKind::usage);
}

/// The words of the command line, the last one first. "help COMMAND" is "COMMAND --help".
std::vector<std::string> wordsOf(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "help") {
    words.erase(words.begin());
    words.push_back("--help");
  }
  std::reverse(words.begin(), words.end());
  return words;
}

/// All commands and options of the program.
void addCommands(CLI::App& app, CommandLine& line) {
  app.set_version_flag("--version", "cradle " CRADLE_VERSION);
  app.add_flag_function(
      "-q,--quiet",
      [&line](std::int64_t count) {
        line.quiet = true;
        if (count > 1) silenceWarnings();
      },
      "no progress on stderr; twice (-qq): no warnings either");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "Example:\n  cradle video scenes/newtons_cradle.json -o cradle.mp4\n'cradle COMMAND --help', or 'cradle help "
      "COMMAND', says more.");
  addSimulate(app, line);
  addPictures(app, line);
  addSample(app, line);
  addSubmit(app, line);
  addPlot(app, line);
  addStudy(app, line);
  addQuestions(app, line);
  checkValues(app);
}

/// Reads words, the last one first. The exit code, if they ask for help or are wrong, which is told then.
std::optional<int> parse(CLI::App& app, const std::vector<std::string>& words) {
  try {
    app.parse(std::vector<std::string>(words));
    return std::nullopt;
  } catch (const CLI::RequiredError& error) {
    if (app.get_subcommands().empty()) refuseUnknownWord(app);
    return answer(app, error);
  } catch (const CLI::ExtrasError& error) {
    refuseUnknownWord(app);
    return answer(app, error);
  } catch (const CLI::ParseError& error) {
    return answer(app, error);
  }
}

int run(int argc, char** argv) {
  std::optional<EndWithoutMemory> end(std::in_place);  // CLI11 asks for memory where it promises to throw nothing
  CLI::App app(kAbout, "cradle");
  CommandLine line;
  addCommands(app, line);
  if (argc <= 1) {
    showText(stderr, app.help());
    return static_cast<int>(ErrorKind::usage);
  }
  if (const auto code = parse(app, wordsOf(argc, argv))) return *code;
  CLI::App ofJobs(kAbout, "cradle");
  CommandLine jobs;
  if (app.got_subcommand("submit")) {  // the words of its jobs are those of a command
    requireScheduler(line.submission.scheduler);
    std::vector<std::string>& words = line.submission.command = app.get_subcommand("submit")->remaining();
    addCommands(ofJobs, jobs);
    if (const auto code = words.empty() ? std::nullopt : parse(ofJobs, {words.rbegin(), words.rend()})) return *code;
    requireSubmittable(words);
    line.submission.pictures = jobs.pictures;
  }
  end.reset();  // commands leave nothing half-written
  line.command();
  flushOutput();
  return 0;
}

int report(const Error& error) {
  show(stderr, "{}\n", error.what());
  if (error.kind() == ErrorKind::interrupted) return kExitOfSignal + interruptingSignal();
  return static_cast<int>(error.kind());
}

/// Of a folder that is gone while the program runs in it, say.
int reportFile(const std::filesystem::filesystem_error& error) {
  const std::string path = error.path1().string();
  return report(
      {ErrorKind::output, path.empty() ? "a path" : path,
       fmt::format(
           "cannot be reached: {}; its folder, and the one that the program runs in, have to be there and readable",
           error.code().message())});
}

/// To the system, an empty TMPDIR names a folder; to people it is none.
void forgetEmptyTemporaryFolder() {
  const char* folder = std::getenv("TMPDIR");
  if (folder != nullptr && *folder == '\0') unsetenv("TMPDIR");
}

/// A thread that cannot be started for lack of memory, or a bug.
int reportUnexpected(const std::exception& error) {
  const auto* ofSystem = dynamic_cast<const std::system_error*>(&error);
  if (ofSystem != nullptr && ofSystem->code() == std::errc::resource_unavailable_try_again)
    return report({ErrorKind::limit, "", "no memory or threads are left; make the scene or the picture smaller"});
  show(stderr, "cradle: {}. This is a bug in cradle.\n", error.what());
  return 1;
}

}  // namespace
}  // namespace cradle

int main(int argc, char** argv) {
  cradle::fillStandardFiles();
  cradle::forgetEmptyTemporaryFolder();
  cradle::noteInterruptions();
  cradle::noteCrashes();
  try {
    return cradle::run(argc, argv);
  } catch (const cradle::Error& error) {
    return cradle::report(error);
  } catch (const std::bad_alloc&) {
    return cradle::report({cradle::ErrorKind::limit, "", "out of memory; make the scene or the picture smaller"});
  } catch (const std::filesystem::filesystem_error& error) {
    return cradle::reportFile(error);
  } catch (const std::exception& error) {
    return cradle::reportUnexpected(error);
  }
}
