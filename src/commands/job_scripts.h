#pragma once

#include <string>
#include <vector>

namespace cradle {

/// A word of a shell command, and a command of such words.
std::string quoted(const std::string& word);
std::string quoted(const std::vector<std::string>& words);

/// Tasks that may run beside each other, behind those of the stage before.
struct JobStage {
  std::string name;
  long tasks = 1;
  std::string script;  // of shell commands, in which $task is 1 .. tasks
};

/// The stage that ends with the name of the first file in a folder that is not there, of those that printf makes of a
/// pattern and numbers.
JobStage checkStage(const std::string& folder, const std::string& pattern, long first, long count);

/// What is to be done, and where what belongs to it is kept.
struct JobPlan {
  std::string folder;
  std::string inputHash;
  std::vector<JobStage> stages;
  long processors = 1;   // of a task
  std::string pictures;  // the folder of the user that they go to; empty if there is none
};

struct JobScript {
  std::string path, text;
};

inline constexpr const char* kRunScript = "run.sh";

/// The script of a stage by its number, from 0 on: $task is its first argument, or what Slurm says.
JobScript stageScript(const JobPlan& plan, std::size_t number);

/// Those of the stages, the same for all schedulers, and run.sh behind them, which starts them one after the other and
/// tells which has not come to its end.
std::vector<JobScript> scriptsOf(const std::string& scheduler, const JobPlan& plan);

/// Whether their files are there with these texts.
bool areThere(const std::vector<JobScript>& scripts);

/// Whether a file of that name may be a script of a stage, or what its tasks have said.
bool isOfStage(const std::string& name);

}  // namespace cradle
