#pragma once

#include "engine/fields.hpp"
#include "engine/kinds.hpp"

#include <string>

namespace troupe::engine {

// What a WorldSpec consists of, described once (engine/description.hpp): storing, restoring, comparing and
// checking worlds (worldio/json/) are ordinary code over these tables. Limits are those of a world that runs
// and can be stored; what an author may write is narrower, and is said by the format that is read.

const FieldTable& world_fields();       ///< WorldSpec
const FieldTable& type_fields();        ///< TypeSpec
const FieldTable& part_fields();        ///< PartSpec
const FieldTable& drive_fields();       ///< DriveSpec
const FieldTable& device_fields();      ///< DeviceSpec
const FieldTable& controller_fields();  ///< ControllerSpec
const FieldTable& measure_fields();     ///< MeasureSpec
const FieldTable& ailment_fields();     ///< FaultSpec::Ailment
const FieldTable& setting_fields();     ///< SettingSpec
const FieldTable& experiment_fields();  ///< ExperimentSpec
const FieldTable& body_fields();        ///< BodySpec
const FieldTable& alias_fields();       ///< NamedBody
const FieldTable& place_fields();       ///< Where

}  // namespace troupe::engine
