#pragma once

#include "engine/fields/fields.hpp"
#include "engine/kinds/kinds.hpp"

#include <string>

namespace troupe::engine {

// The tables below describe the members of a WorldSpec (engine/fields/description.hpp). The code that stores,
// restores, compares and checks worlds (worldio/json/) uses them. A world that check_rules() finds
// consistent, and whose values are within the limits of these tables, can be simulated and stored. Each
// format of world files has narrower limits of its own.

const FieldTable& world_fields();       ///< fields of WorldSpec
const FieldTable& type_fields();        ///< fields of TypeSpec
const FieldTable& part_fields();        ///< fields of PartSpec
const FieldTable& drive_fields();       ///< fields of DriveSpec
const FieldTable& device_fields();      ///< fields of DeviceSpec
const FieldTable& controller_fields();  ///< fields of ControllerSpec
const FieldTable& measure_fields();     ///< fields of MeasureSpec
const FieldTable& impairment_fields();  ///< fields of FaultSpec::Impairment
const FieldTable& setting_fields();     ///< fields of SettingSpec
const FieldTable& experiment_fields();  ///< fields of ExperimentSpec
const FieldTable& body_fields();        ///< fields of BodySpec
const FieldTable& alias_fields();       ///< fields of NamedBody
const FieldTable& place_fields();       ///< fields of Where: a position in a file

}  // namespace troupe::engine
