#pragma once

#include <string>
#include <vector>

#include "commands/pictures.h"

namespace cradle {

struct SubmitOptions {
  std::string scheduler;             // slurm, parallel, or local
  std::vector<std::string> command;  // simulate, render, video or sample, its input, and its options
  PictureOptions pictures;           // among those options
  bool starts = false;               // the jobs, once they are written
};

/// Throws Error(usage) unless it is the name of one.
void requireScheduler(const std::string& scheduler);

/// Throws Error(usage) unless the words of a command begin with one that can be done by jobs, and its input.
void requireSubmittable(const std::vector<std::string>& command);

/// `cradle submit SCHEDULER COMMAND...`: writes into OUTPUT.jobs the scripts that do a command in parts, one stage
/// after the other, and run.sh that starts them. Each task may be ended and started again at any time. If they are
/// started here, this process becomes run.sh, and does not return. Throws Error(usage), Error(output), and what loading
/// the input throws. Scheduler and command are such as the functions above allow.
void submitCommand(const SubmitOptions& options, bool quiet);

}  // namespace cradle
