/* The law of `eha_core.control.inverse_model` in the same order and arithmetic. The equations stand there. */

static double larger(double first, double second) { return first > second ? first : second; }

static double area_b(void) { return PISTON_AREA_B * UNEQUAL_PISTON_AREA_RATIO; }

static double mean_area(void) { return 0.5 * (PISTON_AREA + area_b()); }

/* Of both chambers in series [m^3/Pa]. */
static double compliance(void) {
    return 0.5 * (mean_area() * ACTUATOR_DISPLACEMENT + LINE_VOLUME) / BULK_MODULUS;
}

static double dry_friction(double speed, double sliding, double at_rest, double stribeck_velocity, double shape) {
    return sliding + (at_rest - sliding) * exp(-pow(speed / stribeck_velocity, shape));
}

double eha_friction(double velocity) {
    double speed = fabs(velocity), dry = COULOMB_FRICTION_FORCE;
    double viscous = DAMPING_COEFFICIENT * (1.0 + DIRECTIONAL_DAMPING_RATIO * copysign(1.0, velocity));
    dry += dry_friction(speed, STRIBECK_FRICTION_FORCE, STRIBECK_FRICTION_STATIC_FORCE,
                        STRIBECK_FRICTION_STRIBECK_VELOCITY, STRIBECK_FRICTION_SHAPE);
    dry += dry_friction(speed, PRESLIDING_FRICTION_FORCE, PRESLIDING_FRICTION_STATIC_FORCE,
                        PRESLIDING_FRICTION_STRIBECK_VELOCITY, 2.0);
    viscous += QUADRATIC_DAMPING_COEFFICIENT * speed;
    return viscous * velocity + dry * tanh(velocity / REVERSAL);
}

double eha_force(double position, double velocity, double acceleration) {
    double spring = SPRING_STIFFNESS + HARDENING_SPRING_COEFFICIENT * position * position;
    return MOVING_MASS * acceleration + eha_friction(velocity) + spring * position + CONSTANT_LOAD_FORCE;
}

void eha_pressures(double velocity, double force, double supply_pressure, double *pressure_a, double *pressure_b) {
    double area_a = PISTON_AREA, cubes = pow(area_a, 3.0) + pow(area_b(), 3.0);
    double extending = (area_a * supply_pressure - area_b() * RETURN_PRESSURE - force) / cubes;
    double retracting = (area_b() * supply_pressure - area_a * RETURN_PRESSURE + force) / cubes;
    double share = 0.5 + 0.5 * tanh(velocity / REVERSAL);
    double square_a = area_a * area_a, square_b = area_b() * area_b();
    *pressure_a = share * (supply_pressure - square_a * extending)
                  + (1.0 - share) * (RETURN_PRESSURE + square_a * retracting);
    *pressure_b = share * (RETURN_PRESSURE + square_b * extending)
                  + (1.0 - share) * (supply_pressure - square_b * retracting);
}

void eha_flows(double velocity, double force, double force_rate, double supply_pressure, double *flow_a,
               double *flow_b) {
    double pressure_a, pressure_b, transition = TURBULENT_LEAKAGE_TRANSITION_PRESSURE;
    eha_pressures(velocity, force, supply_pressure, &pressure_a, &pressure_b);
    double load = pressure_a - pressure_b;
    double outside_a = (EXTERNAL_LEAKAGE + EXTERNAL_LEAKAGE_COEFFICIENT_A) * pressure_a;
    double outside_b = (EXTERNAL_LEAKAGE + EXTERNAL_LEAKAGE_COEFFICIENT_B) * pressure_b;
    double lost = INTERNAL_LEAKAGE * load + 0.5 * (outside_a - outside_b);
    lost += TURBULENT_LEAKAGE_COEFFICIENT * load / sqrt(sqrt(load * load + transition * transition));
    lost += compliance() * force_rate / mean_area();
    *flow_a = PISTON_AREA * velocity + lost;
    *flow_b = area_b() * velocity + lost;
}

double eha_spool(double flow_a, double flow_b, double force, double supply_pressure) {
    double total = PISTON_AREA * flow_a * fabs(flow_a) + area_b() * flow_b * fabs(flow_b);
    double square = total / (2.0 * mean_area());
    int extending = square >= 0.0;
    double driving = extending ? PISTON_AREA : area_b(), against = extending ? area_b() : PISTON_AREA;
    double left = driving * supply_pressure - against * RETURN_PRESSURE - (extending ? force : -force);
    double drop = larger(left / (2.0 * mean_area()), LEAST_DROP);
    double gain = VALVE_GAIN * (extending ? 1.0 : 1.0 - FLOW_GAIN_ASYMMETRY_RATIO);
    double opening = copysign(sqrt(fabs(square) / drop) / gain, square);
    opening /= larger(1.0 - FLOW_SATURATION_CURVATURE * fabs(opening), LEAST_SHARE);
    double rounding = larger(VALVE_DEADBAND_ROUNDING, OVERLAP_ROUNDING);
    return opening + VALVE_DEADBAND_HALF_WIDTH * tanh(opening / rounding) - VALVE_NULL_OFFSET_OFFSET;
}

double eha_voltage(double position, double velocity, double acceleration, double supply_pressure) {
    double flow_a, flow_b, force = eha_force(position, velocity, acceleration);
    eha_flows(velocity, force, 0.0, supply_pressure, &flow_a, &flow_b);
    return COIL_RESISTANCE * eha_spool(flow_a, flow_b, force, supply_pressure);
}

double eha_follow(eha_motion *motion, double position, double velocity, double period, double supply_pressure) {
    double flow_a, flow_b, force_rate = 0.0, spool_rate = 0.0;
    double acceleration = motion->started ? (velocity - motion->velocity) / period : 0.0;
    double force = eha_force(position, velocity, acceleration);
    if (motion->started) force_rate = (force - motion->force) / period;
    eha_flows(velocity, force, force_rate, supply_pressure, &flow_a, &flow_b);
    double spool = eha_spool(flow_a, flow_b, force, supply_pressure);
    if (motion->started) spool_rate = (spool - motion->spool) / period;
    *motion = (eha_motion){1, velocity, force, spool};
    double lag = COIL_INDUCTANCE / COIL_RESISTANCE + 2.0 * VALVE_DAMPING_RATIO / VALVE_NATURAL_FREQUENCY;
    double lead = lag + COMMAND_DELAY_DELAY + 0.5 * period; /* half a period: the voltage is held */
    return COIL_RESISTANCE * (spool + lead * spool_rate);
}
