#include "commands/sample_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <thread>

#include "commands/frame_folder.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/part_file.h"
#include "core/read_file.h"
#include "scene/json_document.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSamplePrefix = "sample_";

JsonValue jsonOf(decltype(JsonValue::content) content) {
  return {{}, std::move(content)};
}

JsonMember member(const std::string& key, decltype(JsonValue::content) content) {
  return {key, {}, jsonOf(std::move(content))};
}

JsonValue jsonOf(const SampleRecord& record) {
  JsonValue::Object draws;
  for (const DrawnValue& draw : record.draws) draws.push_back({draw.pointer, {}, draw.value});
  JsonValue::Object object = {member("sample", double(record.number)),   member("folder", sampleName(record.number)),
                              member("seed", double(record.seed)),       member("sceneHash", record.sceneHash),
                              member("redrawn", double(record.redrawn)), member("draws", std::move(draws))};
  if (!record.stateHash.empty()) object.push_back(member("stateHash", record.stateHash));
  if (!record.pictures.empty()) object.push_back(member("pictures", record.pictures));
  if (record.failure) object.push_back(member("failure", *record.failure));
  if (record.tar) object.push_back(member("tar", *record.tar));
  return jsonOf(std::move(object));
}

/// Nothing if there is no such member, or one of another type.
template <class T>
const T* find(const JsonValue& object, const std::string& key) {
  const JsonValue* value = memberOf(object, key);
  return value == nullptr ? nullptr : std::get_if<T>(&value->content);
}

std::optional<std::string> textAt(const JsonValue& object, const std::string& key) {
  const auto* text = find<std::string>(object, key);
  return text == nullptr ? std::nullopt : std::optional(*text);
}

std::optional<SampleRecord> recordOf(const JsonValue& json) {
  const auto *number = find<double>(json, "sample"), *redrawn = find<double>(json, "redrawn"),
             *seed = find<double>(json, "seed");
  const auto* draws = find<JsonValue::Object>(json, "draws");
  const auto sceneHash = textAt(json, "sceneHash");
  if (!number || !redrawn || !draws || !seed || !sceneHash) return std::nullopt;
  SampleRecord record;
  record.number = static_cast<long>(*number), record.redrawn = static_cast<int>(*redrawn);
  record.seed = static_cast<std::uint64_t>(*seed), record.sceneHash = *sceneHash;
  for (const JsonMember& draw : *draws) record.draws.push_back({draw.key, draw.value});
  record.stateHash = textAt(json, "stateHash").value_or("");
  record.pictures = textAt(json, "pictures").value_or("");
  record.failure = textAt(json, "failure");
  record.tar = textAt(json, "tar");
  return record;
}

/// The tree of a file that this program wrote; nothing if it is missing or damaged.
std::optional<JsonValue> readTree(const fs::path& path) {
  std::error_code missing;
  if (!fs::exists(path, missing)) return std::nullopt;
  try {
    FaultList faults(path.string(), ErrorKind::output);
    JsonValue tree = readJson(readFile(path.string(), kLongestText, ErrorKind::output), faults);
    return faults.count() == 0 ? std::optional(std::move(tree)) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool isSampleName(const std::string& name) {
  const std::string digits = name.substr(std::min(name.size(), kSamplePrefix.size()));
  return name.starts_with(kSamplePrefix) && digits.size() == 6 &&
         digits.find_first_not_of("0123456789") == std::string::npos;
}

bool isOurs(const std::string& name) {
  const std::string whole = name.ends_with(".part") ? name.substr(0, name.size() - 5) : name;
  return isSampleName(name) || whole == kIndexFile || (whole.starts_with("samples") && whole.ends_with(".tar"));
}

bool holdsTar(const std::string& folder) {
  const fs::directory_iterator files(folder);
  return std::any_of(begin(files), end(files), [](const auto& file) { return file.path().extension() == ".tar"; });
}

/// All samples that are in a data set or were packed, by their numbers.
std::map<long, SampleRecord> samplesOf(const std::string& folder, const std::vector<SampleRecord>& packed) {
  std::map<long, SampleRecord> samples;
  const fs::path indexPath = fs::path(folder) / kIndexFile;
  const auto index = readTree(indexPath);
  if (!index && fs::exists(indexPath) && holdsTar(folder))
    throw Error(ErrorKind::output, indexPath.string(),
                "cannot be read, and lists samples that were packed; move it away to have one of the others");
  const auto* listed = index ? find<JsonValue::Array>(*index, "samples") : nullptr;
  if (listed != nullptr)
    for (const JsonValue& entry : *listed)
      if (const auto record = recordOf(entry); record && record->tar) samples.insert_or_assign(record->number, *record);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (isSampleName(entry.path().filename().string()))
      if (auto record = readRecord(entry.path().string())) samples.insert_or_assign(record->number, *record);
  for (const SampleRecord& record : packed) samples.insert_or_assign(record.number, record);
  return samples;
}

}  // namespace

std::string sampleName(long number) {
  return fmt::format("{}{:06}", kSamplePrefix, number);
}

void writeRecord(const SampleRecord& record, const std::string& folder) {
  writeWholeFile((fs::path(folder) / kRecordFile).string(), writeJson(jsonOf(record)));
}

std::optional<SampleRecord> readRecord(const std::string& folder) {
  const auto tree = readTree(fs::path(folder) / kRecordFile);
  return tree ? recordOf(*tree) : std::nullopt;
}

void requireSamplesAlone(const std::string& folder) {
  requireOwnFolder(folder, "sample", isOurs);
}

void writeIndex(const std::string& folder, const std::string& scenePath, const std::vector<SampleRecord>& packed) {
  constexpr int kAttempts = 1500;
  constexpr std::chrono::milliseconds kPause(20);  // half a minute in all
  for (int attempt = 1;; ++attempt) {
    std::optional<PartFile> file;
    try {
      file.emplace((fs::path(folder) / kIndexFile).string());  // from here on no other run writes it
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::output || attempt == kAttempts) throw;
      throwIfInterrupted();
      std::this_thread::sleep_for(kPause);
      continue;
    }
    JsonValue::Array entries;
    for (const auto& [number, record] : samplesOf(folder, packed)) entries.push_back(jsonOf(record));
    const JsonValue::Object index = {member("scene", scenePath), member("samples", std::move(entries))};
    file->write(writeJson(jsonOf(index)));
    return file->complete();
  }
}

}  // namespace cradle
