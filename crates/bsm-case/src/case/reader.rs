//! Conversion of the inputs of a case to a model problem in SI units.

use bsm_dyn::{
    Ball, Conformities, Coulomb, Direction, ElasticPoint, Load, Material, Materials, Model,
    OperatingPoint, Problem,
    angles::Angles,
    gothic::{ArchFit, GothicBall},
    lubrication::{
        BaseOil, Losses, Lubricant, LubricatedArch, LubricatedBall, LubricatedModel, Oil,
        Roughness, Temperature, ZERO_CELSIUS,
    },
    model::{Auto, ClosedForm, Elastic, QuasiStatic, RacewayControl, Rigid, Traction},
    solution::{DrivenBody, ScrewSize},
};
use bsm_kin::{Drive, Helix, Scalar};

use crate::vocabulary::entries::Named;
use crate::vocabulary::input_set::lead_angle;
use crate::vocabulary::units::{DEG, GPA, MM, MM2, UM, drive_of_rpm};
use crate::{Case, InputKey, InputSet, ModelChoice, Settings};

/// A function that returns the given or default value of an input, together with the base oil of
/// the lubricant. The values can have any scalar type: numbers for solving, or jets for
/// derivatives.
pub(crate) struct Reader<F>(pub(crate) F, pub(crate) BaseOil);

impl Case {
    /// Returns the base oil of the lubricant.
    pub(crate) fn base_oil(&self) -> BaseOil {
        self.entries.base_oil.map_or(BaseOil::Mineral, |Named(oil)| oil)
    }

    /// Returns a lubricant that can be used for all rows of a table, with only the temperature set
    /// for each row. Returns `None` if a column changes another property of the lubricant, or if
    /// the temperature depends on the losses. Missing inputs take their default values.
    pub fn lubricant_but_for_temperature(&self, columns: InputSet) -> Option<Lubricant> {
        if columns.iter().any(|key| InputSet::CONSTANT_LUBRICANT_INPUTS.contains(key)) {
            return None;
        }
        // The temperature is only a placeholder, because each row has its own temperature.
        let warm = |key| (key == InputKey::lubricant_temperature_C).then_some(40.0);
        let reader = Reader(|key| self.value_or_default(key).or(warm(key)), self.base_oil());
        let lubricant = reader.lubricant()?;
        matches!(lubricant.temperature, Temperature::Known(_)).then_some(lubricant)
    }

    /// Returns a reader for the inputs as plain numbers.
    pub(crate) fn reader(&self) -> Reader<impl Fn(InputKey) -> Option<f64>> {
        Reader(|key| self.value_or_default(key), self.base_oil())
    }
}

impl<D: Scalar, F: Fn(InputKey) -> Option<D>> Reader<F> {
    /// Builds the problem of a model. The caller must have checked the inputs with
    /// [`Case::choose`].
    pub(crate) fn problem(&self, model: ModelChoice, settings: &Settings) -> Problem<D> {
        let lubricant = self.lubricant();
        let model = match (model, &lubricant) {
            (ModelChoice::Fixed(model), None) if !has_grooves(model) => model,
            _ => {
                let arches = GothicArches {
                    fit: self.arch_fit(),
                    far_friction: self.given(InputKey::far_flank_friction_coefficient),
                };
                return in_grooves(self.elastic_point(), lubricant, (model, arches), settings);
            }
        };
        match model {
            Model::ClosedForm => Problem::ClosedForm(ClosedForm {
                angles: self.angles(),
                friction: Coulomb(self.value(InputKey::friction_coefficient)),
                direction: self.direction(),
                size: self.size(),
            }),
            Model::QuasiStatic => Problem::QuasiStatic(self.quasi_static()),
            _ => Problem::Rigid(Rigid { point: self.operating_point() }),
        }
    }

    #[inline]
    fn given(&self, key: InputKey) -> Option<D> {
        (self.0)(key)
    }

    /// Returns the value of an input that the model requires.
    #[inline]
    fn value(&self, key: InputKey) -> D {
        self.given(key).expect("required inputs were checked")
    }

    /// Returns the lead angle \[rad\], either given or calculated from lead and pitch circle.
    pub(crate) fn lead_angle(&self) -> Option<D> {
        if let Some(deg) = self.given(InputKey::lead_angle_deg) {
            return Some(deg * DEG);
        }
        let lead = self.given(InputKey::lead_mm)?;
        Some(lead_angle(lead, self.given(InputKey::pitch_circle_diameter_mm)?))
    }

    fn angles(&self) -> Angles<D> {
        Angles {
            lead: self.lead_angle().expect("required inputs were checked"),
            contact: self.value(InputKey::contact_angle_deg) * DEG,
        }
    }

    /// Returns the speeds of screw and nut, or `None` if the screw speed is missing.
    pub(crate) fn drive(&self) -> Option<Drive<D>> {
        let screw = self.given(InputKey::screw_speed_rpm)?;
        let nut = self.value(InputKey::nut_speed_rpm);
        Some(drive_of_rpm(screw, nut))
    }

    /// Returns the direction in which the screw is driven. The default is rotary to linear.
    fn direction(&self) -> Direction {
        self.drive()
            .and_then(|drive| Direction::of(drive.relative_speed().re()))
            .unwrap_or(Direction::RotaryToLinear)
    }

    fn load(&self) -> Option<Load<D>> {
        let axial = self.given(InputKey::axial_load_N)?;
        Some(Load { axial, balls: self.given(InputKey::loaded_balls)? })
    }

    fn size(&self) -> Option<ScrewSize<D>> {
        Some(ScrewSize {
            pitch_radius: self.given(InputKey::pitch_circle_diameter_mm)? * (0.5 * MM),
            load: self.load()?,
            relative_speed: self.drive().map(|drive| drive.relative_speed()),
        })
    }

    fn quasi_static(&self) -> QuasiStatic<D> {
        let ball = self.value(InputKey::ball_diameter_mm);
        let driven = match self.drive().map(|d| (d.screw_speed.re(), d.nut_speed.re())) {
            Some((screw, nut)) if screw == 0.0 && nut != 0.0 => DrivenBody::Nut,
            Some((_, nut)) if nut != 0.0 => DrivenBody::Both,
            _ => DrivenBody::Screw,
        };
        QuasiStatic {
            angles: self.angles(),
            friction: Coulomb(self.value(InputKey::friction_coefficient)),
            size_ratio: ball / self.value(InputKey::pitch_circle_diameter_mm),
            rolling_ratio: self.value(InputKey::rolling_friction_mm) / (ball * 0.5),
            driven,
            direction: self.direction(),
            size: self.size(),
        }
    }

    /// Returns the elastic constants of raceways and balls.
    pub(crate) fn materials(&self) -> Materials<D> {
        let raceways = Material {
            youngs_modulus: self.value(InputKey::youngs_modulus_GPa) * GPA,
            poisson_ratio: self.value(InputKey::poisson_ratio),
        };
        let (modulus, ratio) = (InputKey::ball_youngs_modulus_GPa, InputKey::ball_poisson_ratio);
        let ball = Material {
            youngs_modulus: self.given(modulus).map_or(raceways.youngs_modulus, |e| e * GPA),
            poisson_ratio: self.given(ratio).unwrap_or(raceways.poisson_ratio),
        };
        Materials { raceways, ball }
    }

    /// Returns the axial play, radial gap and oversize of a ball in its gothic-arch grooves, or
    /// `None` if no play is given.
    pub(crate) fn arch_fit(&self) -> Option<ArchFit<D>> {
        let [play, gap] = [InputKey::axial_play_um, InputKey::radial_gap_um]
            .map(|key| self.given(key).map(|um| um * UM));
        play.or(gap)?;
        let zero = D::from(0.0);
        Some(ArchFit {
            axial_play: play.unwrap_or(zero),
            radial_gap: gap.unwrap_or(zero),
            oversize: zero,
        })
    }

    pub(crate) fn elastic_point(&self) -> ElasticPoint<D> {
        ElasticPoint {
            point: self.operating_point(),
            conformity: Conformities {
                nut: self.value(InputKey::nut_conformity),
                screw: self.value(InputKey::screw_conformity),
            },
            material: self.materials(),
        }
    }

    /// Returns the viscosities at 40 and 100 °C \[m²/s\], either given or derived from the
    /// viscosity grade.
    fn viscosities(&self) -> Option<[D; 2]> {
        let at = |key| Some(self.given(key)? * MM2);
        let given = at(InputKey::viscosity_40C_mm2_s).zip(at(InputKey::viscosity_100C_mm2_s));
        let of_grade = || Oil::of_grade(self.given(InputKey::iso_vg)?.re());
        given.map_or_else(|| Some(of_grade()?.map(D::from)), |(warm, hot)| Some([warm, hot]))
    }

    /// Returns the lubricant, if the case specifies one.
    pub(crate) fn lubricant(&self) -> Option<Lubricant<D>> {
        let viscosities = self.viscosities()?;
        let base = self.1;
        let boundary_friction = self.value(InputKey::boundary_friction_coefficient);
        let kelvin = |key| Some(self.given(key)? + ZERO_CELSIUS);
        let roughness = |key| self.value(key) * UM;
        let or = |key, typical: f64| self.given(key).unwrap_or(D::from(typical));
        Some(Lubricant {
            oil: Oil {
                base,
                viscosities,
                density: or(InputKey::lubricant_density_kg_m3, base.density()),
                pressure_viscosity: self
                    .given(InputKey::pressure_viscosity_1_GPa)
                    .map(|alpha| alpha / D::from(GPA)),
                limiting_shear: or(InputKey::limiting_shear_ratio, base.limiting_shear()),
            },
            temperature: match self.given(InputKey::heat_transfer_W_K) {
                Some(heat_transfer) => Temperature::Balance {
                    heat_transfer,
                    ambient: kelvin(InputKey::ambient_temperature_C)?,
                },
                None => Temperature::Known(kelvin(InputKey::lubricant_temperature_C)?),
            },
            boundary_friction,
            roughness: Roughness {
                ball: roughness(InputKey::ball_roughness_um),
                nut: roughness(InputKey::nut_roughness_um),
                screw: roughness(InputKey::screw_roughness_um),
            },
            film_factor: self.value(InputKey::film_factor),
            rolling_factor: self.value(InputKey::rolling_factor),
            hysteresis_loss: self.value(InputKey::hysteresis_loss),
            losses: Losses {
                seal_torque: self.value(InputKey::seal_torque_Nm),
                ball_contact_force: self.value(InputKey::ball_contact_force_N),
                ball_contact_friction: self
                    .given(InputKey::ball_contact_friction)
                    .unwrap_or(boundary_friction),
                return_circuits: self.value(InputKey::return_circuits),
                return_loss: self.value(InputKey::return_loss_coefficient),
                drag_coefficient: or(InputKey::drag_coefficient, 0.0),
            },
        })
    }

    pub(crate) fn operating_point(&self) -> OperatingPoint<D> {
        let angles = self.angles();
        let radius = self.value(InputKey::ball_diameter_mm) * (0.5 * MM);
        // Models of lubricated balls do not use the friction coefficient.
        let friction = self.given(InputKey::friction_coefficient).unwrap_or(D::from(f64::NAN));
        OperatingPoint {
            helix: Helix {
                radius: self.value(InputKey::pitch_circle_diameter_mm) * (0.5 * MM),
                lead_angle: angles.lead,
            },
            contact_angle: angles.contact,
            ball: Ball::of_density(radius, self.value(InputKey::density_kg_m3)),
            friction: Coulomb(friction),
            drive: self.drive().expect("required inputs were checked"),
            load: self.load().expect("required inputs were checked"),
        }
    }
}

/// Returns true if the balls of a model touch the grooves.
pub(crate) fn has_grooves(model: Model) -> bool {
    matches!(model, Model::RacewayControl | Model::Elastic | Model::Traction)
}

/// Ball clearance and friction in gothic-arch grooves. Only the `traction` model accounts for
/// contact with the far flanks.
#[derive(Default)]
pub(crate) struct GothicArches<D> {
    /// Clearance of the ball in its gothic-arch grooves; `None` if the balls have two contacts.
    fit: Option<ArchFit<D>>,
    /// Friction coefficient at the far flanks; `None` if it is the same as at the loaded flanks.
    far_friction: Option<D>,
}

/// Returns the problem of a model that calculates friction in the grooves, dry or lubricated.
pub(crate) fn in_grooves<D: Scalar>(
    at: ElasticPoint<D>,
    lubricant: Option<Lubricant<D>>,
    (model, arches): (ModelChoice, GothicArches<D>),
    settings: &Settings,
) -> Problem<D> {
    let Settings { tolerance, accuracy, creep, control, friction, .. } = *settings;
    let GothicArches { fit, far_friction } = arches;
    if let (ModelChoice::Fixed(Model::Traction), None, Some(fit)) = (model, &lubricant, fit) {
        let far_friction = far_friction.map_or(at.point.friction, Coulomb);
        return Problem::GothicArch(GothicBall { screw: at, fit, far_friction, accuracy, creep });
    }
    let at = fit.map_or(at, |fit| at.fitted(fit.radial_gap, fit.oversize));
    if let Some(lubricant) = lubricant {
        let model = if model == Model::RacewayControl.into() {
            LubricatedModel::RacewayControl(RacewayControl { screw: at, control }, friction)
        } else {
            LubricatedModel::Traction(Traction { screw: at, accuracy, creep })
        };
        let ball = LubricatedBall { lubricant, model };
        return match fit {
            Some(fit) => {
                // `at` already has the contact angle that results from the radial gap, so the
                // radial gap in `fit` is set to 0.
                let fit = ArchFit { radial_gap: D::from(0.0), ..fit };
                Problem::LubricatedArch(LubricatedArch { ball, fit, far_friction })
            }
            None => Problem::Lubricated(ball),
        };
    }
    match model {
        ModelChoice::Fixed(Model::RacewayControl) => {
            Problem::RacewayControl(RacewayControl { screw: at, control })
        }
        ModelChoice::Fixed(Model::Elastic) => Problem::Elastic(Elastic { screw: at }),
        ModelChoice::Fixed(Model::Traction) => {
            Problem::Traction(Traction { screw: at, accuracy, creep })
        }
        _ => Problem::Auto(Auto { screw: at, tolerance }),
    }
}
