#pragma once

#include "engine/fields/fields.hpp"

#include <string>

namespace troupe::engine {

// Each function below returns a table that describes the members of one struct: their names, types, units,
// limits and defaults (engine/fields/description.hpp). The structs are WorldSpec, the description of a world,
// and the structs that it consists of. The code that stores, restores, compares and checks worlds
// (worldio/json/) uses the tables. A world can be simulated and stored if its values are within the limits of
// the tables, and if check_rules(), which compares the members with one another, finds it consistent. Each
// format of world files has narrower limits of its own.

const FieldTable& world_fields();       ///< fields of WorldSpec: a whole world
const FieldTable& type_fields();        ///< fields of TypeSpec: what identical bodies share
const FieldTable& part_fields();        ///< fields of PartSpec: a rigid part of a body type
const FieldTable& drive_fields();       ///< fields of DriveSpec: the drive of a body type
const FieldTable& device_fields();      ///< fields of DeviceSpec: a sensor or other device of a body type
const FieldTable& controller_fields();  ///< fields of ControllerSpec: a controller of a body type
const FieldTable& measure_fields();     ///< fields of MeasureSpec: a measure that a run computes
const FieldTable& impairment_fields();  ///< fields of FaultSpec::Impairment: a fault that may occur
const FieldTable& setting_fields();     ///< fields of SettingSpec: new values of parameters
const FieldTable& experiment_fields();  ///< fields of ExperimentSpec: stop conditions, interventions, faults
const FieldTable& body_fields();        ///< fields of BodySpec: a body
const FieldTable& alias_fields();       ///< fields of NamedBody: a further name of a body
const FieldTable& place_fields();       ///< fields of Where: a position in a file

}  // namespace troupe::engine
