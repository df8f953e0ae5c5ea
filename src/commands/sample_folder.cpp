#include "commands/sample_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
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

/// JSON has no infinities: null.
JsonValue finiteOrNull(double number) {
  return std::isfinite(number) ? jsonOf(number) : jsonOf(nullptr);
}

JsonValue jsonOf(const std::vector<WishOutcome>& wishes) {
  JsonValue::Array outcomes;
  for (const WishOutcome& wish : wishes)
    outcomes.push_back(
        jsonOf(JsonValue::Object{{"distance", {}, finiteOrNull(wish.distance)}, member("met", wish.isMet)}));
  return jsonOf(std::move(outcomes));
}

/// How much of a sample is told.
enum class Detail { listed, whole };

JsonValue jsonOf(const ChainRecord& chain, Detail detail) {
  JsonValue::Object object = {member("number", double(chain.chain)), member("iteration", double(chain.iteration)),
                              member("accepted", chain.isAccepted), member("sameAs", double(chain.sameAs))};
  object.push_back({"logLikelihood", {}, finiteOrNull(chain.state.logLikelihood)});
  if (detail == Detail::listed) return jsonOf(std::move(object));
  JsonValue::Object numbers;
  for (const auto& [place, ofPlace] : chain.state.numbers) {
    JsonValue::Array values;
    for (const double number : ofPlace) values.push_back(jsonOf(number));
    numbers.push_back({place, {}, jsonOf(std::move(values))});
  }
  object.push_back(member("numbers", std::move(numbers)));
  if (chain.state.impacts.empty() && chain.state.bumpChanges.empty()) return jsonOf(std::move(object));
  JsonValue::Array changes;
  for (const NamedBumpChange& change : chain.state.bumpChanges)
    changes.push_back(jsonOf(JsonValue::Object{member("body", change.body), member("impact", double(change.impact)),
                                               member("seed", double(change.seed))}));
  object.push_back(member("bumpChanges", std::move(changes)));
  JsonValue::Object impacts;
  for (const auto& [body, count] : chain.state.impacts) impacts.push_back(member(body, double(count)));
  object.push_back(member("impacts", std::move(impacts)));
  return jsonOf(std::move(object));
}

JsonValue jsonOf(const ChainSummary& chain) {
  return jsonOf(JsonValue::Object{
      member("number", double(chain.chain)), member("samples", double(chain.samples)),
      member("accepted", double(chain.accepted)), member("autocorrelationTime", chain.autocorrelationTime),
      member("effectiveSamples", chain.effectiveSamples()), member("met", double(chain.met))});
}

JsonValue::Array textsOf(const std::vector<std::string>& texts) {
  JsonValue::Array array;
  for (const std::string& text : texts) array.push_back(jsonOf(text));
  return array;
}

/// A number of a frame, or a word.
decltype(JsonValue::content) horizonOf(const std::string& text) {
  long frame = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), frame);
  if (fault != std::errc() || end != text.data() + text.size()) return text;
  return static_cast<double>(frame);
}

JsonValue jsonOf(const SampleRecord& record, Detail detail) {
  JsonValue::Object draws;
  for (const DrawnValue& draw : record.draws) draws.push_back({draw.pointer, {}, draw.value});
  JsonValue::Object object = {member("sample", double(record.number)),   member("folder", sampleName(record.number)),
                              member("seed", double(record.seed)),       member("sceneHash", record.sceneHash),
                              member("redrawn", double(record.redrawn)), member("draws", std::move(draws))};
  if (!record.stateHash.empty()) object.push_back(member("stateHash", record.stateHash));
  if (!record.horizon.empty()) object.push_back(member("horizon", horizonOf(record.horizon)));
  if (!record.pictures.empty()) object.push_back(member("pictures", record.pictures));
  if (record.failure) object.push_back(member("failure", *record.failure));
  if (record.tar) object.push_back(member("tar", *record.tar));
  if (detail == Detail::whole && !record.warnings.empty())
    object.push_back(member("warnings", textsOf(record.warnings)));
  if (!record.wishes.empty()) object.push_back({"wishes", {}, jsonOf(record.wishes)});
  if (record.chain) object.push_back({"chain", {}, jsonOf(*record.chain, detail)});
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

std::vector<WishOutcome> outcomesAt(const JsonValue& json) {
  std::vector<WishOutcome> outcomes;
  const auto* wishes = find<JsonValue::Array>(json, "wishes");
  if (wishes == nullptr) return outcomes;
  for (const JsonValue& wish : *wishes) {
    const auto* distance = find<double>(wish, "distance");
    const auto* isMet = find<bool>(wish, "met");
    outcomes.push_back({distance ? *distance : INFINITY, isMet && *isMet});
  }
  return outcomes;
}

UniformNumbers numbersAt(const JsonValue& json) {
  UniformNumbers numbers;
  const auto* places = find<JsonValue::Object>(json, "numbers");
  if (places == nullptr) return numbers;
  for (const JsonMember& place : *places)
    if (const auto* values = std::get_if<JsonValue::Array>(&place.value.content))
      for (const JsonValue& value : *values)
        if (const auto* number = std::get_if<double>(&value.content)) numbers[place.key].push_back(*number);
  return numbers;
}

std::vector<NamedBumpChange> bumpChangesAt(const JsonValue& json) {
  std::vector<NamedBumpChange> changes;
  if (const auto* array = find<JsonValue::Array>(json, "bumpChanges"))
    for (const JsonValue& change : *array) {
      const auto *impact = find<double>(change, "impact"), *seed = find<double>(change, "seed");
      const auto* body = find<std::string>(change, "body");
      if (impact && seed && body)
        changes.push_back({*body, static_cast<int>(*impact), static_cast<std::uint64_t>(*seed)});
    }
  return changes;
}

ImpactCounts impactsAt(const JsonValue& json) {
  ImpactCounts impacts;
  if (const auto* bodies = find<JsonValue::Object>(json, "impacts"))
    for (const JsonMember& body : *bodies)
      if (const auto* count = std::get_if<double>(&body.value.content)) impacts[body.key] = static_cast<int>(*count);
  return impacts;
}

std::optional<ChainRecord> chainOf(const JsonValue& json) {
  const auto *number = find<double>(json, "number"), *iteration = find<double>(json, "iteration"),
             *sameAs = find<double>(json, "sameAs");
  const auto* isAccepted = find<bool>(json, "accepted");
  if (!number || !iteration || !sameAs || !isAccepted) return std::nullopt;
  const auto* logLikelihood = find<double>(json, "logLikelihood");
  return ChainRecord{
      static_cast<long>(*number),
      static_cast<long>(*iteration),
      *isAccepted,
      static_cast<long>(*sameAs),
      {numbersAt(json), logLikelihood ? *logLikelihood : -INFINITY, bumpChangesAt(json), impactsAt(json)}};
}

std::optional<ChainSummary> summaryOf(const JsonValue& json) {
  const auto *number = find<double>(json, "number"), *samples = find<double>(json, "samples"),
             *accepted = find<double>(json, "accepted"), *time = find<double>(json, "autocorrelationTime"),
             *met = find<double>(json, "met");
  if (!number || !samples || !accepted || !time || !met) return std::nullopt;
  return ChainSummary{static_cast<long>(*number), static_cast<long>(*samples), static_cast<long>(*accepted),
                      static_cast<long>(*met), *time};
}

/// The numbers that all states of a chain have, and their likelihoods: a series of each.
std::vector<std::vector<double>> seriesOf(const std::vector<const SampleRecord*>& chain) {
  std::map<std::pair<std::string, std::size_t>, std::vector<double>> numbers;
  std::vector<double> likelihoods;
  for (const SampleRecord* record : chain) {
    likelihoods.push_back(record->chain->state.logLikelihood);
    for (const auto& [place, ofPlace] : record->chain->state.numbers) {
      if (place == kBumpSeedPlace) continue;  // changes of bumps replace it bit by bit
      for (std::size_t i = 0; i < ofPlace.size(); ++i) numbers[{place, i}].push_back(ofPlace[i]);
    }
  }
  std::vector<std::vector<double>> series;
  // All the same where each state meets its wishes wholly, which says nothing of how a chain moves.
  const auto isOther = [first = likelihoods.front()](double value) { return value != first; };
  const bool isSeries =
      std::all_of(likelihoods.begin(), likelihoods.end(), [](double value) { return std::isfinite(value); }) &&
      std::any_of(likelihoods.begin(), likelihoods.end(), isOther);
  if (isSeries) series.push_back(std::move(likelihoods));
  for (auto& [place, values] : numbers)
    if (values.size() == chain.size()) series.push_back(std::move(values));
  return series;
}

ChainSummary summaryOf(long number, const std::vector<const SampleRecord*>& chain) {
  ChainSummary summary;
  summary.chain = number, summary.samples = static_cast<long>(chain.size());
  for (const SampleRecord* record : chain) {
    if (record->chain->isAccepted && record->chain->iteration > 0) ++summary.accepted;
    if (!record->wishes.empty() && areAllMet(record->wishes)) ++summary.met;
  }
  for (const std::vector<double>& series : seriesOf(chain))
    summary.autocorrelationTime = std::max(summary.autocorrelationTime, autocorrelationTime(series));
  return summary;
}

std::vector<std::string> textsAt(const JsonValue& json, const std::string& key) {
  std::vector<std::string> texts;
  if (const auto* array = find<JsonValue::Array>(json, key))
    for (const JsonValue& element : *array)
      if (const auto* text = std::get_if<std::string>(&element.content)) texts.push_back(*text);
  return texts;
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
  const auto* horizon = find<double>(json, "horizon");
  record.horizon = horizon ? fmt::format("{}", *horizon) : textAt(json, "horizon").value_or("");
  record.pictures = textAt(json, "pictures").value_or("");
  record.failure = textAt(json, "failure");
  record.tar = textAt(json, "tar");
  record.wishes = outcomesAt(json);
  record.warnings = textsAt(json, "warnings");
  if (const JsonValue* chain = memberOf(json, "chain")) record.chain = chainOf(*chain);
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

/// What an index lists.
struct Listed {
  std::map<long, SampleRecord> samples;
  std::map<long, ChainSummary> chains;
};

/// All samples that are in a data set or were packed, by their numbers, and their chains.
Listed listedOf(const std::string& folder, const std::vector<SampleRecord>& packed) {
  Listed all;
  std::map<long, SampleRecord>& samples = all.samples;
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
  const auto* chains = index ? find<JsonValue::Array>(*index, "chains") : nullptr;
  if (chains != nullptr)
    for (const JsonValue& entry : *chains)
      if (const auto summary = summaryOf(entry)) all.chains.insert_or_assign(summary->chain, *summary);
  std::vector<SampleRecord> records;
  for (const auto& [number, record] : samples) records.push_back(record);
  for (const ChainSummary& summary : summariesOf(records)) all.chains.insert_or_assign(summary.chain, summary);
  return all;
}

}  // namespace

std::string sampleName(long number) {
  return fmt::format("{}{:06}", kSamplePrefix, number);
}

std::vector<ChainSummary> summariesOf(const std::vector<SampleRecord>& records) {
  std::map<long, std::vector<const SampleRecord*>> chains;
  for (const SampleRecord& record : records)
    if (record.chain && (!record.chain->state.numbers.empty() || !record.chain->state.impacts.empty()))
      chains[record.chain->chain].push_back(&record);
  std::vector<ChainSummary> summaries;
  for (const auto& [number, chain] : chains) summaries.push_back(summaryOf(number, chain));
  return summaries;
}

void writeRecord(const SampleRecord& record, const std::string& folder) {
  writeWholeFile((fs::path(folder) / kRecordFile).string(), writeJson(jsonOf(record, Detail::whole)));
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
    const Listed listed = listedOf(folder, packed);
    JsonValue::Array samples, chains;
    for (const auto& [number, record] : listed.samples) samples.push_back(jsonOf(record, Detail::listed));
    for (const auto& [number, summary] : listed.chains) chains.push_back(jsonOf(summary));
    JsonValue::Object index = {member("scene", scenePath), member("samples", std::move(samples))};
    if (!chains.empty()) index.push_back(member("chains", std::move(chains)));
    file->write(writeJson(jsonOf(index)));
    return file->complete();
  }
}

}  // namespace cradle
