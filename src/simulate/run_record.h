#pragma once

#include <string>
#include <string_view>

#include "simulate/lasting_contacts.h"
#include "simulate/step_loss.h"
#include "simulate/world_record.h"

namespace cradle {

/// A run at a frame, at which all steps end, and what was told of it by then.
struct RunRecord {
  WorldRecord world;
  LastingContacts contacts;
  StepLoss::Energies energies;
  std::vector<std::string> warnings;
  long events = 0;        // but those of lasting contacts
  double cpuSeconds = 0;  // of integration
};

std::string bytesOf(const RunRecord& record);

/// With those bytes.
Checkpoint checkpointOf(const RunRecord& record, const std::string& bytes);

/// Of this build. Throws Error(output) if they are damaged.
RunRecord runRecordOf(std::string_view bytes);

}  // namespace cradle
