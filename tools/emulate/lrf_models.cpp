#include "tools/emulate/lrf_models.hpp"

#include <utility>

#include "core/base/check.hpp"
#include "tools/emulate/csv_device.hpp"
#include "tools/emulate/ldrobot_device.hpp"
#include "tools/emulate/rplidar_device.hpp"
#include "tools/emulate/scip_device.hpp"
#include "tools/emulate/sick_device.hpp"
#include "tools/emulate/sopas_device.hpp"
#include "tools/emulate/ydlidar_device.hpp"

namespace odoless {

std::vector<EmulatedLrfModel> emulated_lrf_models() {
  std::vector<EmulatedLrfModel> models;
  for (const ScipModel& model : scip_models()) {
    models.push_back({std::string(model.name), std::string(model.product), model.turn_ns(), model.range_sd_m});
  }
  for (const SickModel& model : sick_models()) {
    models.push_back({std::string(model.name), std::string(model.product), sick::kTurnNs, model.range_sd_m});
  }
  for (const RplidarModel& model : rplidar_models()) {
    models.push_back({std::string(model.name), std::string(model.product), model.turn_ns, model.range_sd_m});
  }
  for (const LdrobotModel& model : ldrobot_models()) {
    models.push_back({std::string(model.name), std::string(model.product), model.turn_ns, model.range_sd_m});
  }
  for (const YdlidarModel& model : ydlidar_models()) {
    models.push_back({std::string(model.name), std::string(model.product), model.turn_ns, model.range_sd_m});
  }
  for (const SopasModel& model : sopas_models()) {
    models.push_back({std::string(model.name), std::string(model.product), model.scan_ns, model.range_sd_m});
  }
  models.push_back(
      {std::string(CsvDevice::kName), std::string(CsvDevice::kProduct), CsvDevice::kTurnNs, CsvDevice::kRangeSdM});
  return models;
}

std::unique_ptr<EmulatedLrf> make_emulated_lrf(std::string_view name, EmulatedScans& source, EmulatedLrfOptions options,
                                               std::int64_t now_ns) {
  if (const ScipModel* const model = find_scip_model(name); model != nullptr) {
    return std::make_unique<ScipDevice>(*model, source, std::move(options), now_ns);
  }
  if (const SickModel* const model = find_sick_model(name); model != nullptr) {
    return std::make_unique<SickDevice>(*model, source, std::move(options));
  }
  if (const LdrobotModel* const model = find_ldrobot_model(name); model != nullptr) {
    return std::make_unique<LdrobotDevice>(*model, source, std::move(options));
  }
  if (const YdlidarModel* const model = find_ydlidar_model(name); model != nullptr) {
    return std::make_unique<YdlidarDevice>(*model, source, std::move(options));
  }
  if (const SopasModel* const model = find_sopas_model(name); model != nullptr) {
    return std::make_unique<SopasDevice>(*model, source, std::move(options), now_ns);
  }
  if (name == CsvDevice::kName) {
    return std::make_unique<CsvDevice>(source, std::move(options), now_ns);
  }
  const RplidarModel* const model = find_rplidar_model(name);
  ODOLESS_CHECK(model != nullptr);
  return std::make_unique<RplidarDevice>(*model, source, std::move(options));
}

}  // namespace odoless
