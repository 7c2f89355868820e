"""The words of the program with their types. Written by `python python/write_vocabulary.py`."""

from typing import Any, Literal, TypedDict

from ballscrew import _core

Model = Literal[
    "auto",
    "closed-form",
    "quasi-static",
    "rigid",
    "raceway-control",
    "elastic",
    "traction",
]
Control = Literal[
    "nut",
    "screw",
]
Friction = Literal[
    "local",
    "contact",
]
Output = Literal[
    "efficiency",
    "screw_torque_Nm",
    "nut_normal_load_N",
    "screw_normal_load_N",
    "minor_normal_load_N",
    "nut_contact_angle_deg",
    "screw_contact_angle_deg",
    "nut_slip_angle_deg",
    "screw_slip_angle_deg",
    "minor_slip_angle_deg",
    "nut_slip_velocity_m_s",
    "screw_slip_velocity_m_s",
    "minor_slip_velocity_m_s",
    "nut_spin_rad_s",
    "screw_spin_rad_s",
    "ball_precession_rad_s",
    "ball_omega_t_rad_s",
    "ball_omega_n_rad_s",
    "ball_omega_b_rad_s",
    "nut_max_pressure_MPa",
    "screw_max_pressure_MPa",
    "nut_ellipse_a_mm",
    "nut_ellipse_b_mm",
    "screw_ellipse_a_mm",
    "screw_ellipse_b_mm",
    "nut_approach_um",
    "screw_approach_um",
    "axial_displacement_um",
    "input_power_W",
    "output_power_W",
    "dissipated_power_W",
    "power_balance",
    "iterations",
    "residual_norm",
    "lubricant_temperature_C",
    "viscosity_mPas",
    "pressure_viscosity_1_GPa",
    "nut_film_um",
    "screw_film_um",
    "nut_film_ratio",
    "screw_film_ratio",
    "nut_asperity_share",
    "screw_asperity_share",
    "nut_friction_coefficient",
    "screw_friction_coefficient",
    "nut_rolling_moment_Nmm",
    "screw_rolling_moment_Nmm",
    "nut_entrainment_m_s",
    "screw_entrainment_m_s",
    "sliding_power_W",
    "rolling_power_W",
    "seal_power_W",
    "ball_contact_power_W",
    "return_power_W",
    "drag_power_W",
    "film_heating_K",
    "equivalent_friction_coefficient",
    "catalogue_friction_coefficient",
    "skid_number",
    "onset_number",
    "efficiency_error_bound",
    "loss_error_bound",
    "self_locking",
    "controlling_race",
    "control_consistent",
    "other_solutions",
    "other_solution_efficiency",
    "evidence",
    "gyroscopic_angle_deg",
    "gyroscopic_yaw_angle_deg",
    "ball_slip_printed_m_s",
    "ball_slip_m_s",
    "nut_differential_slip_m_s",
    "screw_differential_slip_m_s",
    "minor_differential_slip_m_s",
    "nut_slide_roll_ratio",
    "screw_slide_roll_ratio",
    "minor_slide_roll_ratio",
    "nut_rolling_speed_m_s",
    "screw_rolling_speed_m_s",
    "minor_rolling_speed_m_s",
    "nut_spin_slip_printed_m_s",
    "screw_spin_slip_printed_m_s",
    "minor_spin_slip_printed_m_s",
    "nut_spin_slip_corrected_m_s",
    "screw_spin_slip_corrected_m_s",
    "minor_spin_slip_corrected_m_s",
    "minor_spin_rad_s",
    "nut_orbit_slip_printed_m_s",
    "screw_orbit_slip_printed_m_s",
    "minor_orbit_slip_printed_m_s",
    "nut_orbit_slip_corrected_m_s",
    "screw_orbit_slip_corrected_m_s",
    "minor_orbit_slip_corrected_m_s",
    "nut_orbit_spin_rad_s",
    "screw_orbit_spin_rad_s",
    "minor_orbit_spin_rad_s",
    "nut_spin_slip_m_s",
    "screw_spin_slip_m_s",
    "minor_spin_slip_m_s",
    "nut_orbit_slip_m_s",
    "screw_orbit_slip_m_s",
    "minor_orbit_slip_m_s",
    "nut_used_friction_coefficient",
    "screw_used_friction_coefficient",
    "minor_used_friction_coefficient",
    "nut_tangent_friction_moment_Nmm",
    "screw_tangent_friction_moment_Nmm",
    "minor_tangent_friction_moment_Nmm",
    "gyroscopic_moment_Nmm",
    "nut_centre_power_W",
    "screw_centre_power_W",
    "minor_centre_power_W",
    "nut_spin_power_W",
    "screw_spin_power_W",
    "minor_spin_power_W",
    "nut_curvature_power_W",
    "screw_curvature_power_W",
    "minor_curvature_power_W",
    "nut_friction_power_W",
    "screw_friction_power_W",
    "minor_friction_power_W",
    "total_friction_power_W",
    "power_difference",
    "nut_settled_load_N",
    "screw_settled_load_N",
    "minor_settled_load_N",
    "nut_settled_angle_deg",
    "screw_settled_angle_deg",
    "minor_settled_angle_deg",
    "nut_elastic_approach_um",
    "screw_elastic_approach_um",
    "minor_elastic_approach_um",
    "nut_permanent_approach_um",
    "screw_permanent_approach_um",
    "minor_permanent_approach_um",
    "nut_total_approach_um",
    "screw_total_approach_um",
    "minor_total_approach_um",
    "nut_settled_pressure_MPa",
    "screw_settled_pressure_MPa",
    "minor_settled_pressure_MPa",
    "nut_yield_ratio",
    "screw_yield_ratio",
    "minor_yield_ratio",
    "contacts_yield",
    "orbit_rate_rad_s",
    "ball_omega_rad_s",
    "centrifugal_force_N",
    "centrifugal_over_load",
    "drag_force_N",
    "drag_over_load",
    "wedge_angle_deg",
    "nut_friction_across_N",
    "screw_friction_across_N",
    "minor_friction_across_N",
    "holding_force_N",
    "expelling_force_N",
    "locking_ratio",
    "critical_friction_coefficient",
    "nut_critical_friction_printed",
    "screw_critical_friction_printed",
    "minor_critical_friction_printed",
    "critical_friction_simplified",
    "critical_friction_corrected",
    "widest_wedge_deg",
    "locking_friction_coefficient",
    "locking_margin",
    "self_locking_under_load",
    "approach_speed_m_s",
    "impact_force_N",
    "apex_thrust_N",
    "step_force_N",
    "step_thrust_N",
    "highest_step_mm",
    "entry_thrust_ratio",
    "entry_thrust_N",
    "screw_track_friction_N",
    "weaker_track_friction_N",
    "stopped_track_friction_N",
    "returner_margin",
    "published_margin",
    "weaker_contact_margin",
    "jams",
    "rotary_to_linear_optimum_contact_angle_deg",
    "linear_to_rotary_optimum_contact_angle_deg",
    "rotary_to_linear_optimum_lead_angle_deg",
    "linear_to_rotary_optimum_lead_angle_deg",
    "rotary_to_linear_optimum_efficiency",
    "linear_to_rotary_optimum_efficiency",
    "rotary_to_linear_self_locking_contact_angle_deg",
    "linear_to_rotary_self_locking_contact_angle_deg",
    "rotary_to_linear_self_locking_lead_angle_deg",
    "linear_to_rotary_self_locking_lead_angle_deg",
    "rotary_to_linear_efficiency",
    "linear_to_rotary_efficiency",
    "dynamic_load_rating_N",
    "static_load_rating_N",
    "edge_load_N",
    "rigidity_characteristic_N_um15",
    "preload_displacement_um",
    "contact_displacement_um",
    "secant_contact_rigidity_N_um",
    "tangent_contact_rigidity_N_um",
    "preloaded_contact_rigidity_N_um",
    "body_rigidity_N_um",
    "preloaded_body_rigidity_N_um",
    "secant_rigidity_N_um",
    "tangent_rigidity_N_um",
    "preloaded_rigidity_N_um",
    "rolling_efficiency",
    "mass_kg",
    "permissible_speed_rpm",
    "speed_number_mm_min",
    "mean_load_N",
    "mean_speed_rpm",
    "rating_life_revolutions",
    "life_h",
    "ball_gap_mm",
    "nut_groove_radius_mm",
    "screw_groove_radius_mm",
    "nut_groove_offset_mm",
    "screw_groove_offset_mm",
    "nut_core_diameter_mm",
    "screw_core_diameter_mm",
    "nut_root_diameter_mm",
    "screw_root_diameter_mm",
    "nut_edge_angle_deg",
    "screw_edge_angle_deg",
    "nut_groove_section_mm2",
    "screw_groove_section_mm2",
    "gamma",
    "f_c",
    "C_s_N",
    "C_s_over_C_n",
    "C_i_N",
    "screw_curvature_along_1_mm",
    "screw_curvature_across_1_mm",
    "k_0_N_mm2",
    "nut_approach_um_N23",
    "screw_approach_um_N23",
    "nut_displacement_um",
    "nut_side_displacement_um",
    "nut_tilt_urad",
    "max_contact_load_N",
    "max_over_mean",
    "unloaded_balls",
    "max_pressure_MPa",
    "equal_load_N",
    "load_bound_N",
    "nut_stiffness_N_um",
    "secant_stiffness_N_um",
    "equal_stiffness_N_um",
    "rigidity_2_N_um",
    "rigidity_2_83_N_um",
    "rigidity_3_N_um",
    "iso_rigidity_N_um",
    "usual_rigidity_N_um",
    "preload_set_N",
    "warm_preload_N",
    "preload_approach_um",
    "preload_setting_um",
    "preload_left_N",
    "limit_load_N",
    "life_revolutions",
    "iso_life_revolutions",
    "life_ratio",
    "static_safety",
    "friction_torque_Nm",
    "friction_torque_error_Nm",
    "return_torque_Nm",
    "nut_seal_torque_Nm",
    "drive_torque_Nm",
    "nut_efficiency",
    "friction_heat_W",
    "preload_torque_Nm",
    "preload_torque_factor",
    "rule_torque_low_Nm",
    "rule_torque_high_Nm",
    "largest_load_N",
    "largest_speed_rpm",
    "largest_feed_m_min",
    "equivalent_load_N",
    "equivalent_speed_rpm",
    "screw_length_between_bearings_mm",
    "bending_diameter_mm",
    "critical_speed_rpm",
    "critical_speed_ratio",
    "buckling_load_N",
    "buckling_safety",
    "yield_load_N",
    "cycle_speed_number_mm_min",
    "screw_mass_kg",
    "steady_temperature_rise_K",
    "screw_growth_um",
    "travel_variation_300_um",
    "static_safety_factor",
    "cycle_life_revolutions",
    "cycle_life_h",
    "cycle_life_by_balls_h",
    "opening_load_N",
    "screw_rigidity_N_um",
    "nut_rigidity_N_um",
    "axis_rigidity_N_um",
    "lost_motion_um",
    "peak_motor_torque_Nm",
    "rms_motor_torque_Nm",
    "peak_motor_power_W",
    "mean_heat_W",
    "preload_drag_Nm",
    "screw_efficiency",
    "contact_drag_Nm",
    "holding_torque_Nm",
    "inertia_of_screw_kg_m2",
    "inertia_of_mass_kg_m2",
    "inertia_at_motor_kg_m2",
    "inertia_ratio",
]


class Inputs(TypedDict, total=False):
    """Inputs of a scene."""

    description: str
    ball_diameter_mm: float | None
    pitch_circle_diameter_mm: float | None
    lead_angle_deg: float | None
    lead_mm: float | None
    contact_angle_deg: float | None
    nut_running_contact_angle_deg: float | None
    screw_running_contact_angle_deg: float | None
    nut_conformity: float | None
    screw_conformity: float | None
    friction_coefficient: float | None
    rolling_friction_mm: float | None
    density_kg_m3: float | None
    youngs_modulus_GPa: float | None
    poisson_ratio: float | None
    ball_youngs_modulus_GPa: float | None
    ball_poisson_ratio: float | None
    screw_speed_rpm: float | None
    feed_m_min: float | None
    nut_speed_rpm: float | None
    axial_load_N: float | None
    loaded_balls: float | None
    loaded_balls_per_turn: float | None
    loaded_turns: float | None
    preload_N: float | None
    preload_offset_um: float | None
    ball_oversize_um: float | None
    ball_deviation_sd_um: float | None
    seed: float | None
    starts: float | None
    circuits_count: float | None
    gap_deg: float | None
    phase_deg: float | None
    radial_gap_um: float | None
    reference_z_mm: float | None
    radial_load_x_N: float | None
    radial_load_y_N: float | None
    moment_x_Nm: float | None
    moment_y_Nm: float | None
    radial_x_um: float | None
    radial_y_um: float | None
    tilt_x_urad: float | None
    tilt_y_urad: float | None
    guide_x_N_um: float | None
    guide_y_N_um: float | None
    guide_tilt_x_Nm_mrad: float | None
    guide_tilt_y_Nm_mrad: float | None
    nut_anchor_z_mm: float | None
    screw_anchor_z_mm: float | None
    nut_EA_N: float | None
    screw_EA_N: float | None
    screw_rating_N: float | None
    nut_rating_N: float | None
    nut_temperature_rise_K: float | None
    screw_temperature_rise_K: float | None
    ball_temperature_rise_K: float | None
    thermal_expansion_um_m_K: float | None
    nut_outer_diameter_mm: float | None
    nut_length_mm: float | None
    groove_bottom_distance_mm: float | None
    axial_play_um: float | None
    nut_bore_mm: float | None
    screw_outer_diameter_mm: float | None
    speed_number_limit_mm_min: float | None
    race_yield_strength_MPa: float | None
    ball_yield_strength_MPa: float | None
    lubricant_density_kg_m3: float | None
    drag_coefficient: float | None
    iso_vg: float | None
    viscosity_40C_mm2_s: float | None
    viscosity_100C_mm2_s: float | None
    pressure_viscosity_1_GPa: float | None
    limiting_shear_ratio: float | None
    boundary_friction_coefficient: float | None
    lubricant_temperature_C: float | None
    heat_transfer_W_K: float | None
    ambient_temperature_C: float | None
    ball_roughness_um: float | None
    nut_roughness_um: float | None
    screw_roughness_um: float | None
    film_factor: float | None
    rolling_factor: float | None
    hysteresis_loss: float | None
    seal_torque_Nm: float | None
    ball_contact_force_N: float | None
    ball_contact_friction: float | None
    return_circuits: float | None
    return_loss_coefficient: float | None
    apex_half_angle_deg: float | None
    return_angle_deg: float | None
    step_normal_force_N: float | None
    return_approach_speed_m_s: float | None
    return_stiffness_N_um15: float | None
    return_linear_stiffness_N_um: float | None
    step_height_mm: float | None
    rated_dynamic_load_N: float | None
    rated_static_load_N: float | None
    stroke_mm: float | None
    unsupported_length_mm: float | None
    shaft_diameter_mm: float | None
    moved_mass_kg: float | None
    inclination_deg: float | None
    guide_friction: float | None
    motor_inertia_kg_m2: float | None
    coupling_inertia_kg_m2: float | None
    gear_ratio: float | None
    support_bearing_torque_Nm: float | None
    support_bearing_rigidity_N_um: float | None
    housing_rigidity_N_um: float | None
    reliability_percent: float | None
    axis_heat_transfer_W_K: float | None
    required_life_h: float | None
    required_static_safety: float | None
    required_critical_speed_ratio: float | None
    required_buckling_safety: float | None
    circuits: Any
    bars: Any
    ring: Any
    ring_expansion: Any
    nut_guidance: Any
    nut_anchor: Any
    screw_anchor: Any
    screw_torsion: Any
    preload_by: Any
    preload_arrangement: Any
    ball_deviation_um: Any
    lead_error: Any
    base_oil: Any
    ball_precession_rad_s: Any
    support: Any
    accuracy_grade: Any
    cycle: Any


class SceneFields(_core.Scene):
    """A property for each input."""

    __slots__ = ()

    @property
    def ball_diameter_mm(self) -> float | None:
        """Ball diameter [mm]."""
        return self.number(0)

    @property
    def pitch_circle_diameter_mm(self) -> float | None:
        """Diameter of the circle of ball centres [mm]."""
        return self.number(1)

    @property
    def lead_angle_deg(self) -> float | None:
        """Lead angle of the ball-centre helix; or give lead_mm [deg]."""
        return self.number(2)

    @property
    def lead_mm(self) -> float | None:
        """Lead, axial advance per turn; or give lead_angle_deg [mm]."""
        return self.number(3)

    @property
    def contact_angle_deg(self) -> float | None:
        """Contact angle, 0 radial, 90 axial; unloaded in the elastic models [deg]."""
        return self.number(4)

    @property
    def nut_running_contact_angle_deg(self) -> float | None:
        """Contact angle at the nut in motion, for slip with model raceway-control; found by the model
        unless given [deg]."""
        return self.number(5)

    @property
    def screw_running_contact_angle_deg(self) -> float | None:
        """Contact angle at the screw in motion, for slip with model raceway-control; found by the model
        unless given [deg]."""
        return self.number(6)

    @property
    def nut_conformity(self) -> float | None:
        """Groove radius over ball diameter, nut."""
        return self.number(7)

    @property
    def screw_conformity(self) -> float | None:
        """Groove radius over ball diameter, screw."""
        return self.number(8)

    @property
    def friction_coefficient(self) -> float | None:
        """Coulomb friction coefficient."""
        return self.number(9)

    @property
    def rolling_friction_mm(self) -> float | None:
        """Lever arm of rolling resistance [mm]; 0 unless given."""
        return self.number(10)

    @property
    def density_kg_m3(self) -> float | None:
        """Density of the ball [kg/m3]; 7800 unless given."""
        return self.number(11)

    @property
    def youngs_modulus_GPa(self) -> float | None:
        """Young's modulus of the races, and of the ball unless given for it [GPa]; 207 unless given."""
        return self.number(12)

    @property
    def poisson_ratio(self) -> float | None:
        """Poisson's ratio of the races, and of the ball unless given for it; 0.3 unless given."""
        return self.number(13)

    @property
    def ball_youngs_modulus_GPa(self) -> float | None:
        """Young's modulus of the ball, if it differs from the races [GPa]."""
        return self.number(14)

    @property
    def ball_poisson_ratio(self) -> float | None:
        """Poisson's ratio of the ball, if it differs from the races."""
        return self.number(15)

    @property
    def screw_speed_rpm(self) -> float | None:
        """Speed of the screw about the axis; screw minus nut speed > 0 drives against the load, < 0 is
        back-driving [rpm]."""
        return self.number(16)

    @property
    def feed_m_min(self) -> float | None:
        """Velocity of the nut along the screw, in place of screw_speed_rpm; needs the lead [m/min]."""
        return self.number(17)

    @property
    def nut_speed_rpm(self) -> float | None:
        """Speed of the nut about the axis [rpm]; 0 unless given."""
        return self.number(18)

    @property
    def axial_load_N(self) -> float | None:
        """Axial load on the nut, carried by all loaded balls together [N]."""
        return self.number(19)

    @property
    def loaded_balls(self) -> float | None:
        """Number of balls that share the load equally; loaded_balls_per_turn times loaded_turns, or those
        of the circuits, unless given."""
        return self.number(20)

    @property
    def loaded_balls_per_turn(self) -> float | None:
        """Loaded balls per turn, for the load ratings of a nut; may be a fraction."""
        return self.number(21)

    @property
    def loaded_turns(self) -> float | None:
        """Loaded turns of a nut, for its load ratings; may be a fraction."""
        return self.number(22)

    @property
    def preload_N(self) -> float | None:
        """Preload, axial force between the two nuts of a preloaded pair, or of oversize balls on either
        flank (preload_by) [N]."""
        return self.number(23)

    @property
    def preload_offset_um(self) -> float | None:
        """Axial offset of the two nuts of a pair against each other, in place of preload_N: > 0 pulls them
        together (X arrangement), < 0 pushes them apart (O) [um]."""
        return self.number(24)

    @property
    def ball_oversize_um(self) -> float | None:
        """Excess of the diameter of all balls over the one that just touches both flanks of a nut; < 0 is
        play [um]."""
        return self.number(25)

    @property
    def ball_deviation_sd_um(self) -> float | None:
        """Standard deviation of the diameters of the balls of a nut, drawn with seed [um]."""
        return self.number(26)

    @property
    def seed(self) -> float | None:
        """Number that the random deviations of the balls follow from; 0 unless given."""
        return self.number(27)

    @property
    def starts(self) -> float | None:
        """Threads of the screw; 1 unless given."""
        return self.number(28)

    @property
    def circuits_count(self) -> float | None:
        """Circuits of balls that the loaded turns of a nut are divided into; 1 unless given."""
        return self.number(29)

    @property
    def gap_deg(self) -> float | None:
        """Arc without loaded balls between two circuits of one thread; up to the next whole turn unless
        given [deg]."""
        return self.number(30)

    @property
    def phase_deg(self) -> float | None:
        """Helix angle by which each circuit is shifted against the one before, besides arc and gap [deg]; 0
        unless given."""
        return self.number(31)

    @property
    def radial_gap_um(self) -> float | None:
        """Radial gap between grooves and balls of a nut at rest [um]; 0 unless given."""
        return self.number(32)

    @property
    def reference_z_mm(self) -> float | None:
        """Place on the axis to which displacements, side loads and moments of a nut belong; the middle of
        its balls unless given [mm]."""
        return self.number(33)

    @property
    def radial_load_x_N(self) -> float | None:
        """Side load on the nut along x [N]."""
        return self.number(34)

    @property
    def radial_load_y_N(self) -> float | None:
        """Side load on the nut along y [N]."""
        return self.number(35)

    @property
    def moment_x_Nm(self) -> float | None:
        """Moment on the nut about x [N m]."""
        return self.number(36)

    @property
    def moment_y_Nm(self) -> float | None:
        """Moment on the nut about y [N m]."""
        return self.number(37)

    @property
    def radial_x_um(self) -> float | None:
        """Misalignment, side displacement along x at which the nut is held [um]."""
        return self.number(38)

    @property
    def radial_y_um(self) -> float | None:
        """Misalignment, side displacement along y at which the nut is held [um]."""
        return self.number(39)

    @property
    def tilt_x_urad(self) -> float | None:
        """Misalignment, tilt about x at which the nut is held [urad]."""
        return self.number(40)

    @property
    def tilt_y_urad(self) -> float | None:
        """Misalignment, tilt about y at which the nut is held [urad]."""
        return self.number(41)

    @property
    def guide_x_N_um(self) -> float | None:
        """Stiffness of the guides of the nut against side motion along x [N/um]."""
        return self.number(42)

    @property
    def guide_y_N_um(self) -> float | None:
        """Stiffness of the guides of the nut against side motion along y [N/um]."""
        return self.number(43)

    @property
    def guide_tilt_x_Nm_mrad(self) -> float | None:
        """Stiffness of the guides of the nut against tilt about x [N m/mrad]."""
        return self.number(44)

    @property
    def guide_tilt_y_Nm_mrad(self) -> float | None:
        """Stiffness of the guides of the nut against tilt about y [N m/mrad]."""
        return self.number(45)

    @property
    def nut_anchor_z_mm(self) -> float | None:
        """Place on the axis where the force leaves the nut; or nut_anchor [mm]."""
        return self.number(46)

    @property
    def screw_anchor_z_mm(self) -> float | None:
        """Place on the axis where the force leaves the screw; or screw_anchor [mm]."""
        return self.number(47)

    @property
    def nut_EA_N(self) -> float | None:
        """Young's modulus times cross section of the nut; from its diameters unless given [N]."""
        return self.number(48)

    @property
    def screw_EA_N(self) -> float | None:
        """Young's modulus times cross section of the screw; from its groove diameter unless given [N]."""
        return self.number(49)

    @property
    def screw_rating_N(self) -> float | None:
        """Dynamic load rating of the screw's side of one nut body; from the geometry unless given [N]."""
        return self.number(50)

    @property
    def nut_rating_N(self) -> float | None:
        """Dynamic load rating of the nut's side of one nut body; from the geometry unless given [N]."""
        return self.number(51)

    @property
    def nut_temperature_rise_K(self) -> float | None:
        """Temperature of the nut above the one at which it fits [K]; 0 unless given."""
        return self.number(52)

    @property
    def screw_temperature_rise_K(self) -> float | None:
        """Temperature of the screw above the one at which it fits [K]; 0 unless given."""
        return self.number(53)

    @property
    def ball_temperature_rise_K(self) -> float | None:
        """Temperature of the balls above the one at which they fit [K]; 0 unless given."""
        return self.number(54)

    @property
    def thermal_expansion_um_m_K(self) -> float | None:
        """Coefficient of thermal expansion of nut, screw and balls [um/(m K)]; 11.5 unless given."""
        return self.number(55)

    @property
    def nut_outer_diameter_mm(self) -> float | None:
        """Outer diameter of the nut, for its rigidity and mass; pitch circle + 4 ball diameters unless
        given [mm]."""
        return self.number(56)

    @property
    def nut_length_mm(self) -> float | None:
        """Length of the nut, for its mass; loaded_turns + 3 leads unless given [mm]."""
        return self.number(57)

    @property
    def groove_bottom_distance_mm(self) -> float | None:
        """Radial distance of the bottoms of the groove arcs of nut and screw, half the difference of their
        core diameters; gives the contact angle of a nut's ratings in place of contact_angle_deg [mm]."""
        return self.number(58)

    @property
    def axial_play_um(self) -> float | None:
        """Axial play of one nut without preload, for its thread; 0 is a gothic arch that the balls touch at
        four points [um]; 0 unless given."""
        return self.number(59)

    @property
    def nut_bore_mm(self) -> float | None:
        """Diameter of the land of the nut, for its mass and the ends of its flanks; pitch circle + 1.5 mm
        unless given, for balls below 3 mm + half a ball [mm]."""
        return self.number(60)

    @property
    def screw_outer_diameter_mm(self) -> float | None:
        """Diameter of the land of the screw, for the ends of its flanks; pitch circle - 1.5 mm unless
        given, for balls below 3 mm - half a ball [mm]."""
        return self.number(61)

    @property
    def speed_number_limit_mm_min(self) -> float | None:
        """Largest speed number, pitch circle diameter times speed, that the ball return permits [mm/min];
        70000 unless given."""
        return self.number(62)

    @property
    def race_yield_strength_MPa(self) -> float | None:
        """Yield strength of the races, for the margin of the contacts against yield [MPa]."""
        return self.number(63)

    @property
    def ball_yield_strength_MPa(self) -> float | None:
        """Yield strength of the balls, for the margin of the contacts against yield [MPa]."""
        return self.number(64)

    @property
    def lubricant_density_kg_m3(self) -> float | None:
        """Density of the lubricant, at 15 C where it varies with temperature; that of base_oil unless
        given, for drag in jam none [kg/m3]."""
        return self.number(65)

    @property
    def drag_coefficient(self) -> float | None:
        """Drag coefficient of a ball in the lubricant."""
        return self.number(66)

    @property
    def iso_vg(self) -> float | None:
        """Viscosity grade of the lubricant, for one of viscosity index 95, unless viscosity_40C_mm2_s and
        viscosity_100C_mm2_s are given."""
        return self.number(67)

    @property
    def viscosity_40C_mm2_s(self) -> float | None:
        """Kinematic viscosity of the lubricant at 40 C, of a grease that of its base oil [mm2/s]."""
        return self.number(68)

    @property
    def viscosity_100C_mm2_s(self) -> float | None:
        """Kinematic viscosity of the lubricant at 100 C, less than at 40 C [mm2/s]."""
        return self.number(69)

    @property
    def pressure_viscosity_1_GPa(self) -> float | None:
        """Pressure-viscosity coefficient at the temperature of the lubricant; from viscosity and base_oil
        unless given [1/GPa]."""
        return self.number(70)

    @property
    def limiting_shear_ratio(self) -> float | None:
        """Largest shear stress of the lubricant over pressure; that of base_oil unless given."""
        return self.number(71)

    @property
    def boundary_friction_coefficient(self) -> float | None:
        """Friction coefficient where asperities touch; 0.09 with friction modifiers, 0.15 at the start;
        0.12 unless given."""
        return self.number(72)

    @property
    def lubricant_temperature_C(self) -> float | None:
        """Temperature of the lubricant at the inlet of the contacts, unless heat_transfer_W_K and
        ambient_temperature_C are given [C]."""
        return self.number(73)

    @property
    def heat_transfer_W_K(self) -> float | None:
        """Heat that leaves the nut for each kelvin above ambient_temperature_C, in place of
        lubricant_temperature_C [W/K]."""
        return self.number(74)

    @property
    def ambient_temperature_C(self) -> float | None:
        """Temperature of the surroundings [C]."""
        return self.number(75)

    @property
    def ball_roughness_um(self) -> float | None:
        """Root mean square roughness of the balls, 1.25 times the arithmetic one: 0.01 to 0.03 [um]."""
        return self.number(76)

    @property
    def nut_roughness_um(self) -> float | None:
        """Root mean square roughness of the nut's groove: ground 0.1 to 0.3, run in half of it [um]."""
        return self.number(77)

    @property
    def screw_roughness_um(self) -> float | None:
        """Root mean square roughness of the screw's groove: ground 0.1 to 0.3, run in half of it, rolled
        0.3 to 0.6 [um]."""
        return self.number(78)

    @property
    def film_factor(self) -> float | None:
        """Film thickness over that of plenty of lubricant; 0.7 (0.4 to 1) for grease; 1 unless given."""
        return self.number(79)

    @property
    def rolling_factor(self) -> float | None:
        """Rolling force of the lubricant over that of flooded inlets; 0.85 unless given."""
        return self.number(80)

    @property
    def hysteresis_loss(self) -> float | None:
        """Part of the elastic energy of the contacts that rolling loses, 0.003 to 0.034; 0.01 unless
        given."""
        return self.number(81)

    @property
    def seal_torque_Nm(self) -> float | None:
        """Friction torque of the seals, of the maker or measured; felt wipers 0.02 to 0.3 [N m]; 0 unless
        given."""
        return self.number(82)

    @property
    def ball_contact_force_N(self) -> float | None:
        """Force between neighbouring balls, 0.1 to 1; 0 with spacer balls [N]; 0 unless given."""
        return self.number(83)

    @property
    def ball_contact_friction(self) -> float | None:
        """Friction coefficient between balls; boundary_friction_coefficient unless given."""
        return self.number(84)

    @property
    def return_circuits(self) -> float | None:
        """Number of ball returns that lose kinetic energy of the balls; 0 unless given."""
        return self.number(85)

    @property
    def return_loss_coefficient(self) -> float | None:
        """Kinetic energy that a ball loses in a return over its own, 1 to 4 for in and out; 0 unless
        given."""
        return self.number(86)

    @property
    def apex_half_angle_deg(self) -> float | None:
        """Half angle of the apex of the return curve, for jamming [deg]."""
        return self.number(87)

    @property
    def return_angle_deg(self) -> float | None:
        """Angle between the return channel and the track of the screw at the steps between them, for
        jamming [deg]."""
        return self.number(88)

    @property
    def step_normal_force_N(self) -> float | None:
        """Normal force of the step on the ball, for jamming; the impact force unless given [N]."""
        return self.number(89)

    @property
    def return_approach_speed_m_s(self) -> float | None:
        """Speed at which a ball enters the ball return, for jamming; its speed in the nut unless given
        [m/s]."""
        return self.number(90)

    @property
    def return_stiffness_N_um15(self) -> float | None:
        """Hertz stiffness of the impact on the ball return, for jamming; that of a ball on a flat of race
        material unless given [N/um^1.5]."""
        return self.number(91)

    @property
    def return_linear_stiffness_N_um(self) -> float | None:
        """Linear stiffness of the impact on the ball return, for jamming, in place of
        return_stiffness_N_um15 [N/um]."""
        return self.number(92)

    @property
    def step_height_mm(self) -> float | None:
        """Height of the step over which a ball enters the ball return, for jamming [mm]."""
        return self.number(93)

    @property
    def rated_dynamic_load_N(self) -> float | None:
        """Dynamic load rating as the maker states it, in place of the calculated one [N]."""
        return self.number(94)

    @property
    def rated_static_load_N(self) -> float | None:
        """Static load rating as the maker states it, in place of the calculated one [N]."""
        return self.number(95)

    @property
    def stroke_mm(self) -> float | None:
        """Stroke of the nut; the screw is longer by the length of the nut [mm]."""
        return self.number(96)

    @property
    def unsupported_length_mm(self) -> float | None:
        """Length of the screw between its bearings; stroke_mm + length of the nut + two leads unless given
        [mm]."""
        return self.number(97)

    @property
    def shaft_diameter_mm(self) -> float | None:
        """Diameter of the screw that bends and strains; the calculated core diameter of its thread unless
        given [mm]."""
        return self.number(98)

    @property
    def moved_mass_kg(self) -> float | None:
        """Mass that the axis moves; its weight, friction and inertia are added to the axial load [kg]; 0
        unless given."""
        return self.number(99)

    @property
    def inclination_deg(self) -> float | None:
        """Inclination of the axis: 0 level, 90 upwards along the feed [deg]; 0 unless given."""
        return self.number(100)

    @property
    def guide_friction(self) -> float | None:
        """Friction coefficient of the guides under the moved mass; 0 unless given."""
        return self.number(101)

    @property
    def motor_inertia_kg_m2(self) -> float | None:
        """Moment of inertia of the motor [kg m2]; 0 unless given."""
        return self.number(102)

    @property
    def coupling_inertia_kg_m2(self) -> float | None:
        """Moment of inertia of what turns with the screw, such as its coupling [kg m2]; 0 unless given."""
        return self.number(103)

    @property
    def gear_ratio(self) -> float | None:
        """Turns of the motor for one of the screw; 1 unless given."""
        return self.number(104)

    @property
    def support_bearing_torque_Nm(self) -> float | None:
        """Friction torque of the support bearings [N m]; 0 unless given."""
        return self.number(105)

    @property
    def support_bearing_rigidity_N_um(self) -> float | None:
        """Axial rigidity of the support bearings; rigid unless given [N/um]."""
        return self.number(106)

    @property
    def housing_rigidity_N_um(self) -> float | None:
        """Axial rigidity of the housings of bearings and nut; rigid unless given [N/um]."""
        return self.number(107)

    @property
    def reliability_percent(self) -> float | None:
        """Share of the nuts that reach the life [%]; 90 unless given."""
        return self.number(108)

    @property
    def axis_heat_transfer_W_K(self) -> float | None:
        """Heat that screw and nut give to their surroundings for a kelvin, for the steady temperature of
        the axis [W/K]."""
        return self.number(109)

    @property
    def required_life_h(self) -> float | None:
        """Life that is required [h]."""
        return self.number(110)

    @property
    def required_static_safety(self) -> float | None:
        """Static safety that is required; 1.5 unless given."""
        return self.number(111)

    @property
    def required_critical_speed_ratio(self) -> float | None:
        """Largest speed over the critical one that is permitted; 0.8 unless given."""
        return self.number(112)

    @property
    def required_buckling_safety(self) -> float | None:
        """Buckling load over the largest axial load that is required; 2 unless given."""
        return self.number(113)


class SolutionFields(_core.Solution):
    """A property for each output; NaN where the model has none."""

    __slots__ = ()

    @property
    def efficiency(self) -> float:
        """Output power over input power; negative: self-locking."""
        return self.number(0)

    @property
    def screw_torque_Nm(self) -> float:
        """Torque on the screw in the steady state, all balls [N m]."""
        return self.number(1)

    @property
    def nut_normal_load_N(self) -> float:
        """Normal load of a ball on the nut [N]."""
        return self.number(2)

    @property
    def screw_normal_load_N(self) -> float:
        """Normal load of a ball on the screw [N]."""
        return self.number(3)

    @property
    def minor_normal_load_N(self) -> float:
        """Normal load of a ball on the minor contact, the opposite flank of the nut [N]."""
        return self.number(4)

    @property
    def nut_contact_angle_deg(self) -> float:
        """Contact angle at the nut [deg]."""
        return self.number(5)

    @property
    def screw_contact_angle_deg(self) -> float:
        """Contact angle at the screw [deg]."""
        return self.number(6)

    @property
    def nut_slip_angle_deg(self) -> float:
        """Direction of friction on the ball at the nut [deg]."""
        return self.number(7)

    @property
    def screw_slip_angle_deg(self) -> float:
        """Direction of friction on the ball at the screw [deg]."""
        return self.number(8)

    @property
    def minor_slip_angle_deg(self) -> float:
        """Direction of friction on the ball at the minor contact [deg]."""
        return self.number(9)

    @property
    def nut_slip_velocity_m_s(self) -> float:
        """Slip speed at the nut [m/s]."""
        return self.number(10)

    @property
    def screw_slip_velocity_m_s(self) -> float:
        """Slip speed at the screw [m/s]."""
        return self.number(11)

    @property
    def minor_slip_velocity_m_s(self) -> float:
        """Slip speed at the minor contact [m/s]."""
        return self.number(12)

    @property
    def nut_spin_rad_s(self) -> float:
        """Spin about the contact normal, relative to the nut [rad/s]."""
        return self.number(13)

    @property
    def screw_spin_rad_s(self) -> float:
        """Spin about the contact normal, relative to the screw [rad/s]."""
        return self.number(14)

    @property
    def ball_precession_rad_s(self) -> float:
        """Precession, the angular velocity of the ball centre about the screw axis [rad/s]."""
        return self.number(15)

    @property
    def ball_omega_t_rad_s(self) -> float:
        """Angular velocity of the ball along the helix [rad/s]."""
        return self.number(16)

    @property
    def ball_omega_n_rad_s(self) -> float:
        """Angular velocity of the ball towards the axis [rad/s]."""
        return self.number(17)

    @property
    def ball_omega_b_rad_s(self) -> float:
        """Angular velocity of the ball along the binormal [rad/s]."""
        return self.number(18)

    @property
    def nut_max_pressure_MPa(self) -> float:
        """Largest Hertz pressure at the nut [MPa]."""
        return self.number(19)

    @property
    def screw_max_pressure_MPa(self) -> float:
        """Largest Hertz pressure at the screw [MPa]."""
        return self.number(20)

    @property
    def nut_ellipse_a_mm(self) -> float:
        """Semi-axis across the groove, nut [mm]."""
        return self.number(21)

    @property
    def nut_ellipse_b_mm(self) -> float:
        """Semi-axis along the groove, nut [mm]."""
        return self.number(22)

    @property
    def screw_ellipse_a_mm(self) -> float:
        """Semi-axis across the groove, screw [mm]."""
        return self.number(23)

    @property
    def screw_ellipse_b_mm(self) -> float:
        """Semi-axis along the groove, screw [mm]."""
        return self.number(24)

    @property
    def nut_approach_um(self) -> float:
        """Elastic approach at the nut [um]."""
        return self.number(25)

    @property
    def screw_approach_um(self) -> float:
        """Elastic approach at the screw [um]."""
        return self.number(26)

    @property
    def axial_displacement_um(self) -> float:
        """Axial displacement of the nut [um]."""
        return self.number(27)

    @property
    def input_power_W(self) -> float:
        """Input power, all balls [W]."""
        return self.number(28)

    @property
    def output_power_W(self) -> float:
        """Output power, all balls [W]."""
        return self.number(29)

    @property
    def dissipated_power_W(self) -> float:
        """Dissipated power, all balls [W]."""
        return self.number(30)

    @property
    def power_balance(self) -> float:
        """Relative error of the power balance, rounding only at an exact solution."""
        return self.number(31)

    @property
    def iterations(self) -> float:
        """Newton steps, or sweeps of `rigid`."""
        return self.number(32)

    @property
    def residual_norm(self) -> float:
        """Scaled residual of the equations."""
        return self.number(33)

    @property
    def lubricant_temperature_C(self) -> float:
        """Temperature of the lubricant, given or that at which all losses leave as heat [C]."""
        return self.number(34)

    @property
    def viscosity_mPas(self) -> float:
        """Dynamic viscosity of the lubricant at its temperature [mPa s]."""
        return self.number(35)

    @property
    def pressure_viscosity_1_GPa(self) -> float:
        """Pressure-viscosity coefficient of the lubricant [1/GPa]."""
        return self.number(36)

    @property
    def nut_film_um(self) -> float:
        """Film thickness at the nut [um]."""
        return self.number(37)

    @property
    def screw_film_um(self) -> float:
        """Film thickness at the screw [um]."""
        return self.number(38)

    @property
    def nut_film_ratio(self) -> float:
        """Film thickness over roughness at the nut: below 0.3 boundary, to 2 mixed, above full film."""
        return self.number(39)

    @property
    def screw_film_ratio(self) -> float:
        """Film thickness over roughness at the screw."""
        return self.number(40)

    @property
    def nut_asperity_share(self) -> float:
        """Share of the load that asperities carry at the nut."""
        return self.number(41)

    @property
    def screw_asperity_share(self) -> float:
        """Share of the load that asperities carry at the screw."""
        return self.number(42)

    @property
    def nut_friction_coefficient(self) -> float:
        """Mean friction coefficient at the nut: sliding power over that of a coefficient of one."""
        return self.number(43)

    @property
    def screw_friction_coefficient(self) -> float:
        """Mean friction coefficient at the screw."""
        return self.number(44)

    @property
    def nut_rolling_moment_Nmm(self) -> float:
        """Couple against rolling at the nut, by lubricant and hysteresis [N mm]."""
        return self.number(45)

    @property
    def screw_rolling_moment_Nmm(self) -> float:
        """Couple against rolling at the screw [N mm]."""
        return self.number(46)

    @property
    def nut_entrainment_m_s(self) -> float:
        """Mean speed of both surfaces along the track at the nut [m/s]."""
        return self.number(47)

    @property
    def screw_entrainment_m_s(self) -> float:
        """Mean speed of both surfaces along the track at the screw [m/s]."""
        return self.number(48)

    @property
    def sliding_power_W(self) -> float:
        """Power lost by sliding at the contacts, all balls [W]."""
        return self.number(49)

    @property
    def rolling_power_W(self) -> float:
        """Power lost by rolling resistance of lubricant and hysteresis, all balls [W]."""
        return self.number(50)

    @property
    def seal_power_W(self) -> float:
        """Power lost at the seals, which warms the lubricant; a part of the torque of the whole screw, not
        of dissipated_power_W [W]."""
        return self.number(51)

    @property
    def ball_contact_power_W(self) -> float:
        """Power lost by balls that rub on each other [W]."""
        return self.number(52)

    @property
    def return_power_W(self) -> float:
        """Power lost in the ball returns [W]."""
        return self.number(53)

    @property
    def drag_power_W(self) -> float:
        """Power lost by drag of the balls in the lubricant [W]."""
        return self.number(54)

    @property
    def film_heating_K(self) -> float:
        """By how much sliding heats the hotter film; not in the viscosity [K]."""
        return self.number(55)

    @property
    def equivalent_friction_coefficient(self) -> float:
        """Constant friction coefficient with the same loss of the contacts at this point."""
        return self.number(56)

    @property
    def catalogue_friction_coefficient(self) -> float:
        """Friction coefficient of catalogues, that of a plain thread of the same efficiency."""
        return self.number(57)

    @property
    def skid_number(self) -> float:
        """Gyroscopic moment over friction moment of a ball that grips."""
        return self.number(58)

    @property
    def onset_number(self) -> float:
        """Skid onset number, the skid number times a factor for the friction that the slip of the lead
        takes: below 0.1 the ball grips, above 2 it skids."""
        return self.number(59)

    @property
    def efficiency_error_bound(self) -> float:
        """Bound of the error of the efficiency: in model traction of its integration over the contact
        ellipses; in model auto against model traction, for 99 % of all points. Torque and powers follow
        from the efficiency; the numbers of the ball and of its contacts have no bound where auto takes
        another model than traction."""
        return self.number(60)

    @property
    def loss_error_bound(self) -> float:
        """The same of the power that is lost, relative to the lost power of this result; null: more than
        0.5."""
        return self.number(61)

    @property
    def self_locking(self) -> bool | None:
        """True if the screw is self-locking in this direction."""
        return self.flag(62)

    @property
    def controlling_race(self) -> str | None:
        """Race on which the ball does not spin (raceway control)."""
        return self.word(63)

    @property
    def control_consistent(self) -> bool | None:
        """True if the controlling race has the larger spin friction moment at this solution; false where
        neither race has it at its own solution."""
        return self.flag(64)

    @property
    def other_solutions(self) -> float:
        """Number of other steady motions known at this point; null: unknown, as no search was made or it
        was lost."""
        return self.number(65)

    @property
    def other_solution_efficiency(self) -> float:
        """Efficiency of the other steady motion whose efficiency differs most."""
        return self.number(66)

    @property
    def evidence(self) -> str | None:
        """How sure no_solution is: proof; bound (an expansion whose error is smaller than what decides);
        traced (a curve that contains all solutions was followed in steps of finite size); sampled (also
        random starts found none)."""
        return self.word(67)
