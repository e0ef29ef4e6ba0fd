#pragma once

#include "engine/fields/fields.hpp"
#include "partition/message.hpp"

namespace troupe::engine {

/// Appends a record (a list of values, such as the parameters of a device), together with the types of its
/// values, to a message between ranks (threads or processes that compute a world together).
void put_record(partition::MessageWriter& message, const Record& record);
/// Reads a record that put_record() appended, and returns it. Throws std::logic_error if the message ends
/// before the record does, and allocates no memory for values that the message cannot contain.
Record get_record(partition::MessageReader& message);

}  // namespace troupe::engine
