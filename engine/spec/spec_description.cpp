#include "engine/spec/spec_description.hpp"

#include "base/limits.hpp"
#include "engine/fields/description.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe {

using engine::Description;
namespace facts = engine::facts;

constexpr void describe(Description<Where>& d) {
  d.member<&Where::file>("file");
  d.member<&Where::line>("line");
}

constexpr void describe(Description<ZInterval>& d) {
  d.member<&ZInterval::min>("min");
  d.member<&ZInterval::max>("max");
}

constexpr void describe(Description<Box>& d) {
  d.member<&Box::min>("min");
  d.member<&Box::max>("max");
}

constexpr void describe(Description<Solid>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&Solid::z>("z_m", within(-k_spec_reach_m, k_spec_reach_m));
  d.member<&Solid::contours>("contours", meters, within(-k_spec_reach_m, k_spec_reach_m));
}

}  // namespace troupe

namespace troupe::engine {
namespace {

constexpr double k_most_s = 1e15;       // more than any world needs, and its ticks still fit 64 bits
constexpr double k_most_return = 1e30;  // far within the range of a float

constexpr Fact k_within_reach = facts::within(-k_spec_reach_m, k_spec_reach_m);
constexpr Fact k_time = facts::within(0, k_most_s);

}  // namespace

constexpr auto names_of(RangingEngine) { return k_ranging_engines; }
constexpr auto names_of(Comparison) { return k_comparisons; }
constexpr auto names_of(InterventionSpec::Action) { return k_actions; }
constexpr std::array<std::string_view, 3> names_of(GroupSpec::By) { return {"population", "type", "model"}; }
constexpr std::array<std::string_view, 3> names_of(SettingSpec::Of) {
  return {"drive", "device", "controller"};
}

constexpr void describe(Description<Returns>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&Returns::obstacle>("obstacle");
  d.member<&Returns::ranger>("ranger_return", within(-k_most_return, k_most_return));
  d.member<&Returns::fiducial>("fiducial_return");
  d.member<&Returns::fiducial_key>("fiducial_key");
  d.member<&Returns::gripper>("gripper_return");
  d.member<&Returns::blob>("blob_return");
  d.member<&Returns::pushable>("pushable", is_sparse);
}

constexpr void describe(Description<PartSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&PartSpec::name>("name");
  d.member<&PartSpec::alias>("alias");
  d.member<&PartSpec::kind>("kind");
  d.member<&PartSpec::parent>("parent");
  d.member<&PartSpec::joint>("joint", at_least(k_rigid), is_sparse);
  d.member<&PartSpec::pose_body_part>("pose", k_within_reach);
  d.member<&PartSpec::size>("size", meters, k_within_reach);
  d.member<&PartSpec::solids>("solids");
  d.part<&PartSpec::returns>();
  d.member<&PartSpec::floor_plan>("floor_plan");
  d.derived<&PartSpec::image>();  // not stored: `solids` holds the result and needs no file
  d.derived<&PartSpec::fitted>();
  d.member<&PartSpec::color>("color", k_within_reach);
  d.member<&PartSpec::where>("where", provenance);
}

constexpr void describe(Description<JointSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&JointSpec::name>("name");
  d.member<&JointSpec::parent>("parent", at_least(k_rigid), is_sparse);
  d.member<&JointSpec::pose_body_joint>("pose", k_within_reach);
}

constexpr void describe(Description<DriveSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&DriveSpec::kind>("kind");
  d.member<&DriveSpec::period_s>("period", seconds, k_time);
  d.member<&DriveSpec::params>("params");
  d.member<&DriveSpec::where>("where", provenance);
}

constexpr void describe(Description<DeviceSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&DeviceSpec::name>("name");
  d.member<&DeviceSpec::kind>("kind");
  d.member<&DeviceSpec::part>("part");
  d.member<&DeviceSpec::joint>("joint", at_least(k_rigid), is_sparse);
  d.member<&DeviceSpec::moves>("moves", at_least(k_rigid), is_sparse);
  d.member<&DeviceSpec::pose_body_device>("pose", k_within_reach);
  d.member<&DeviceSpec::period_s>("period", seconds, k_time);
  d.member<&DeviceSpec::active>("active");
  d.member<&DeviceSpec::params>("params");
  d.member<&DeviceSpec::where>("where", provenance);
}

constexpr void describe(Description<ControllerSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&ControllerSpec::kind>("kind");
  d.member<&ControllerSpec::part>("part");
  d.member<&ControllerSpec::period_s>("period", seconds, k_time);
  d.member<&ControllerSpec::params>("params");
  d.member<&ControllerSpec::where>("where", provenance);
}

constexpr void describe(Description<TypeSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&TypeSpec::name>("name");
  d.member<&TypeSpec::parts>("parts");
  d.member<&TypeSpec::joints>("joints", is_sparse);
  d.member<&TypeSpec::drive>("drive");
  d.member<&TypeSpec::devices>("sensors");
  d.member<&TypeSpec::controllers>("controllers");
}

constexpr void describe(Description<RecordSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&RecordSpec::file>("file");
  d.member<&RecordSpec::fields>("fields");
  d.member<&RecordSpec::every_s>("every", seconds, k_time);
  d.member<&RecordSpec::where>("where", provenance);
  d.member<&RecordSpec::where_fields>("where_fields", provenance);
}

constexpr void describe(Description<MeasureSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&MeasureSpec::kind>("kind");
  d.member<&MeasureSpec::name>("name");
  d.member<&MeasureSpec::of>("of");
  d.member<&MeasureSpec::params>("params");
  d.member<&MeasureSpec::where>("where", provenance);
}

constexpr void describe(Description<ReserveSpec>& d) {
  d.member<&ReserveSpec::population>("population");
  d.member<&ReserveSpec::first>("first");
  d.member<&ReserveSpec::count>("count");
}

constexpr void describe(Description<EmptyPopulation>& d) {
  d.member<&EmptyPopulation::name>("name");
  d.member<&EmptyPopulation::type>("type");
}

// An experiment is stored as in a JSON world file. File positions are stored only for whole entries, because
// errors inside an entry were reported when the world was made.

constexpr void describe(Description<StopSpec>& d) {
  d.member<&StopSpec::measure>("measure");
  d.member<&StopSpec::comparison>("is");
  d.member<&StopSpec::value>("value");
}

constexpr void describe(Description<GroupSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&GroupSpec::by>("by");
  d.member<&GroupSpec::name>("name");
  d.member<&GroupSpec::count>("count", at_least(0));
  d.member<&GroupSpec::share>("share", within(0, 1));
}

constexpr void describe(Description<SettingSpec>& d) {
  d.member<&SettingSpec::type>("type");
  d.member<&SettingSpec::of>("of");
  d.member<&SettingSpec::index>("index");
  d.member<&SettingSpec::params>("params");
}

constexpr void describe(Description<InterventionSpec>& d) {
  d.member<&InterventionSpec::time_s>("time", Unit::seconds, k_time);
  d.member<&InterventionSpec::action>("action");
  d.member<&InterventionSpec::whom>("whom");
  d.member<&InterventionSpec::pose>("pose", k_within_reach);
  d.member<&InterventionSpec::region>("region_m", k_within_reach);
  d.member<&InterventionSpec::setting>("setting");
  d.member<&InterventionSpec::where>("where", facts::provenance);
}

constexpr void describe(Description<FaultSpec::Impairment>& d) {
  d.member<&FaultSpec::Impairment::kind>("kind");
  d.member<&FaultSpec::Impairment::params>("params");
}

constexpr void describe(Description<FaultSpec>& d) {
  d.member<&FaultSpec::whom>("whom");
  d.member<&FaultSpec::from_s>("from", Unit::seconds, k_time);
  d.member<&FaultSpec::impairments>("ailments");  // the old name, because checkpoints store it
  d.member<&FaultSpec::where>("where", facts::provenance);
}

constexpr void describe(Description<ExperimentSpec>& d) {
  d.member<&ExperimentSpec::stop_when>("stop_when");
  d.member<&ExperimentSpec::at>("at");
  d.member<&ExperimentSpec::faults>("faults");
}

/// Both members are marked as provenance, so that comparisons of worlds ignore them. Comparisons use the
/// texts of the names instead, because the same name may have another word index in another world.
constexpr void describe(Description<Name>& d) {
  d.member<&Name::word>("word", facts::provenance);
  d.member<&Name::number>("number", facts::provenance);
}

constexpr void describe(Description<BodySpec>& d) {
  d.part<&BodySpec::name>();
  d.member<&BodySpec::type>("type");
  d.member<&BodySpec::pose_world_body>("pose", k_within_reach);
  d.member<&BodySpec::color>("color", k_within_reach);
  d.member<&BodySpec::fiducial>("fiducial", facts::is_sparse);
  d.member<&BodySpec::where>("where", facts::provenance);
}

constexpr void describe(Description<NamedBody>& d) {
  d.part<&NamedBody::name>();
  d.member<&NamedBody::body>("body");
}

constexpr void describe(Description<WorldSpec>& d) {
  using namespace facts;
  using enum engine::Unit;
  d.member<&WorldSpec::title>("title");
  d.member<&WorldSpec::seed>("seed");
  d.member<&WorldSpec::tick_s>("tick", seconds, within(k_least_tick_s, k_most_s));
  d.member<&WorldSpec::quit_time_s>("quit_time", seconds, k_time);
  d.member<&WorldSpec::record>("record");
  d.member<&WorldSpec::measures>("measures");
  d.member<&WorldSpec::measure_every_s>("measure_every", seconds, k_time);
  d.member<&WorldSpec::watch>("watch");
  d.member<&WorldSpec::window>("window");
  d.member<&WorldSpec::ranging>("ranging");
  d.member<&WorldSpec::resolution_m>("resolution", meters);  // World checks its limits
  d.member<&WorldSpec::resolution_where>("resolution_where", provenance);
  d.member<&WorldSpec::bounds>("bounds_m", k_within_reach);
  d.apart<&WorldSpec::files>("files");
  d.apart<&WorldSpec::names>("words");
  d.apart<&WorldSpec::part_aliases>("part_names");
  d.member<&WorldSpec::reserves>("reserves", is_sparse);
  d.member<&WorldSpec::empty_populations>("empty_populations", is_sparse);
  d.member<&WorldSpec::mortal>("mortal", is_sparse);
  d.member<&WorldSpec::contacts>("contacts", is_sparse);
  d.member<&WorldSpec::types>("types");
  d.apart<&WorldSpec::bodies>("bodies");
  d.apart<&WorldSpec::aliases>("aliases");
  d.member<&WorldSpec::experiment>("experiment");
}

const FieldTable& world_fields() { return described<WorldSpec>(); }
const FieldTable& type_fields() { return described<TypeSpec>(); }
const FieldTable& part_fields() { return described<PartSpec>(); }
const FieldTable& drive_fields() { return described<DriveSpec>(); }
const FieldTable& device_fields() { return described<DeviceSpec>(); }
const FieldTable& controller_fields() { return described<ControllerSpec>(); }
const FieldTable& measure_fields() { return described<MeasureSpec>(); }
const FieldTable& impairment_fields() { return described<FaultSpec::Impairment>(); }
const FieldTable& setting_fields() { return described<SettingSpec>(); }
const FieldTable& experiment_fields() { return described<ExperimentSpec>(); }
const FieldTable& body_fields() { return described<BodySpec>(); }
const FieldTable& alias_fields() { return described<NamedBody>(); }
const FieldTable& place_fields() { return described<Where>(); }

}  // namespace troupe::engine
