// A stage is a script that does one of its tasks, the same for all schedulers; run.sh alone differs.

#include "commands/job_scripts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/read_file.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCheck = "check";

std::string scriptFile(std::size_t stage, const JobStage& of) {
  return fmt::format("{}_{}.sh", stage + 1, of.name);
}

std::string stageText(const JobPlan& plan, std::size_t number) {
  const JobStage& stage = plan.stages[number];
  const std::string log = quoted((fs::path(plan.folder) / fmt::format("{}_{}_", number + 1, stage.name)).string());
  std::string text = "#!/bin/sh\n";
  // Without --time, account and partition: those are of the site, which SBATCH_TIMELIMIT, SBATCH_ACCOUNT and
  // SBATCH_PARTITION name.
  text += fmt::format("#SBATCH --job-name=cradle-{}\n#SBATCH --requeue\n#SBATCH --open-mode=append\n", stage.name);
  text += fmt::format("#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={}\n#SBATCH --output=/dev/null\n", plan.processors);
  if (stage.tasks > 1) text += fmt::format("#SBATCH --array=1-{}\n", stage.tasks);
  return text + fmt::format("task={}\nexec >>{}\"$task.log\" 2>&1\n{}",
                            stage.tasks > 1 ? "${1:-$SLURM_ARRAY_TASK_ID}" : "1", log, stage.script);
}

std::string runText(const std::string& scheduler, const JobPlan& plan) {
  std::string text = fmt::format(
      "#!/bin/sh\n# Does all that is not there yet; may be started again at any time.\n"
      "# Of an input with the hash {}.\ncd {} || exit 5\n",
      plan.inputHash, quoted(plan.folder));
  std::string after;
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const JobStage& stage = plan.stages[i];
    const std::string script = scriptFile(i, stage);
    if (scheduler == "slurm") {
      text +=
          fmt::format("job=$(sbatch --parsable{} ./{}) || exit 5\njob=${{job%%;*}}\necho \"{}: job $job, {} task{}\"\n",
                      after, script, stage.name, stage.tasks, stage.tasks == 1 ? "" : "s");
      after = " --dependency=\"afterok:$job\" --kill-on-invalid-dep=yes";
      continue;
    }
    const std::string numbers = fmt::format("seq {} | ", stage.tasks);
    const std::string beside = fmt::format("\"$((($(nproc) + {}) / {}))\"", plan.processors - 1, plan.processors);
    const std::string call = fmt::format("sh {} {{}}", quoted((fs::path(plan.folder) / script).string()));
    if (stage.tasks == 1)  // where it ends it is done, whatever a log says
      text += fmt::format("sh ./{}", script);
    else if (scheduler == "parallel")
      text += fmt::format("{}parallel -j {} --joblog {}_{}.joblog.log --resume-failed {}", numbers, beside, i + 1,
                          stage.name, quoted(call));
    else
      text += fmt::format("{}xargs -P {} -I{{}} {}", numbers, beside, call);
    // Logs of GNU parallel say that missing files were made once: all tasks look again for those.
    const bool forgets = scheduler == "parallel" && stage.name == kCheck;
    text += fmt::format(
        " ||\n  {{ {}echo \"{} has not come to its end, see {}_{}_*.log in $PWD; start $0 again to go on\" >&2; exit "
        "5; "
        "}}\n",
        forgets ? "rm -f ./*.joblog.log; " : "", stage.name, i + 1, stage.name);
  }
  return text;
}

}  // namespace

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char letter : word)
    if (letter == '\'')
      text += "'\\''";
    else
      text += letter;
  return text + "'";
}

std::string quoted(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += ' ';
    text += quoted(word);
  }
  return text;
}

JobStage checkStage(const std::string& folder, const std::string& pattern, long first, long count) {
  return {kCheck, 1,
          fmt::format(
              "number={}\nwhile [ \"$number\" -lt {} ]; do\n"
              "  file={}/$(printf {} \"$number\")\n"
              "  [ -e \"$file\" ] || {{ echo \"$file is missing; start run.sh again to have it made\" >&2; exit 5; }}\n"
              "  number=$((number + 1))\ndone\n",
              first, first + count, quoted(folder), quoted(pattern))};
}

JobScript stageScript(const JobPlan& plan, std::size_t number) {
  const fs::path path = fs::path(plan.folder) / scriptFile(number, plan.stages[number]);
  return {path.string(), stageText(plan, number)};
}

std::vector<JobScript> scriptsOf(const std::string& scheduler, const JobPlan& plan) {
  std::vector<JobScript> scripts;
  for (std::size_t i = 0; i < plan.stages.size(); ++i) scripts.push_back(stageScript(plan, i));
  scripts.push_back({(fs::path(plan.folder) / kRunScript).string(), runText(scheduler, plan)});
  return scripts;
}

bool areThere(const std::vector<JobScript>& scripts) {
  return std::all_of(scripts.begin(), scripts.end(),
                     [](const JobScript& script) { return holdsText(script.path, script.text); });
}

bool isOfStage(const std::string& name) {
  constexpr std::array kStages = {"_simulate", "_render", "_sample", "_check", "_encode"};
  return (name.ends_with(".sh") || name.ends_with(".log")) &&
         std::any_of(kStages.begin(), kStages.end(),
                     [&](const char* stage) { return name.size() > 1 && name.substr(1).starts_with(stage); });
}

}  // namespace cradle
