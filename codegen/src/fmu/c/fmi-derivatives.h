/* Derivatives of states, rates and outputs by states, inputs and parameters. Part of `fmi-functions.c`. */

typedef struct {
    double rates_by_state[STATES * STATES];
    double rates_by_input[ROOM(STATES * ALL_INPUTS)];
    double rates_by_parameter[ROOM(STATES * PARAMETERS)];
    double outputs_by_state[ROOM(OUTPUTS * STATES)];
    double outputs_by_input[ROOM(OUTPUTS * ALL_INPUTS)];
    double outputs_by_parameter[ROOM(OUTPUTS * PARAMETERS)];
    double states_by_state[STATES * STATES];
} Jacobians;

/* The states that follow when one is changed: itself, and the dependent coordinates while initial values are sought. */
static int states_by_state(const Instance *i, double t, const double *x, const double *u, double *to) {
    enum { Q = STATES - SPEEDS };
    double residual[ROOM(DEPENDENT)], jacobian[ROOM(DEPENDENT * Q)];
    double matrix[ROOM(DEPENDENT * DEPENDENT)], right[ROOM(DEPENDENT * Q)];
    int row, column;
    for (row = 0; row < STATES; row++) {
        for (column = 0; column < STATES; column++) {
            to[row * STATES + column] = row == column;
        }
    }
    if (DEPENDENT == 0 || i->now.mode != INITIALIZATION) {
        return 1;
    }
    position_constraints_of_model(t, i->now.p, x, u, residual, jacobian);
    for (row = 0; row < DEPENDENT; row++) {
        for (column = 0; column < DEPENDENT; column++) {
            matrix[row * DEPENDENT + column] = jacobian[row * Q + dependent_coordinates[column]];
        }
        for (column = 0; column < Q; column++) {
            right[row * Q + column] = -jacobian[row * Q + column];
        }
    }
    if (!solved(matrix, right, DEPENDENT, Q)) {
        return 0;
    }
    for (row = 0; row < DEPENDENT; row++) {
        double *line = to + (SPEEDS + dependent_coordinates[row]) * STATES;
        for (column = 0; column < Q; column++) {
            line[SPEEDS + column] = right[row * Q + column];
        }
        for (column = 0; column < DEPENDENT; column++) {
            line[SPEEDS + dependent_coordinates[column]] = 0;
        }
    }
    return 1;
}

/* Derivatives of the outputs by the parameters, by differences of order six. */
static void outputs_by_parameter(const Motion *m, double t, const double *x, const double *u, double *to) {
    static const double weights[3] = {45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0};
    double p[ROOM(PARAMETERS)], above[ROOM(OUTPUTS)], below[ROOM(OUTPUTS)];
    int parameter, k, output;
    memcpy(p, m->p, sizeof p);
    memset(to, 0, (size_t)(OUTPUTS * PARAMETERS) * sizeof *to);
    for (parameter = 0; parameter < PARAMETERS; parameter++) {
        const double h = 1e-3 * (m->p[parameter] != 0 ? fabs(m->p[parameter]) : 1);
        for (k = 0; k < 3; k++) {
            p[parameter] = m->p[parameter] + (k + 1) * h;
            outputs_of_model(t, p, x, u, above);
            p[parameter] = m->p[parameter] - (k + 1) * h;
            outputs_of_model(t, p, x, u, below);
            for (output = 0; output < OUTPUTS; output++) {
                to[output * PARAMETERS + parameter] += weights[k] * (above[output] - below[output]) / h;
            }
        }
        p[parameter] = m->p[parameter];
    }
}

/* All derivatives at the present place. */
static int jacobians_of(const Instance *i, Jacobians *to) {
    double x[STATES], u[ROOM(ALL_INPUTS)], rates[STATES], outputs[ROOM(OUTPUTS)];
    const double t = seen_time(&i->now);
    if (!state_of(i, x)) {
        return 0;
    }
    fill_inputs(&i->now, t, u);
    jacobians_of_model(t, i->now.p, x, u, rates, to->rates_by_state, to->rates_by_input);
    parameter_jacobian_of_model(t, i->now.p, x, u, to->rates_by_parameter);
    if (OUTPUTS > 0) {
        output_jacobians_of_model(t, i->now.p, x, u, outputs, to->outputs_by_state, to->outputs_by_input);
        outputs_by_parameter(&i->now, t, x, u, to->outputs_by_parameter);
    }
    return states_by_state(i, t, x, u, to->states_by_state);
}

/* A row by way of the states. */
static double by_way_of_states(const Jacobians *j, const double *row, int state) {
    double sum = 0;
    int k;
    for (k = 0; k < STATES; k++) {
        sum += row[k] * j->states_by_state[k * STATES + state];
    }
    return sum;
}

/* The derivative of one variable by another; NaN where there is none. */
static double derivative(const Instance *i, const Jacobians *j, fmi3ValueReference unknown, fmi3ValueReference known) {
    const double *by_state, *by_input, *by_parameter;
    if (unknown < FIRST_STATE || unknown >= FIRST_SWITCH || known < FIRST_PARAMETER || known >= FIRST_RATE) {
        return NAN;
    }
    if (unknown < FIRST_RATE) {
        const int row = (int)unknown - FIRST_STATE;
        if (known < FIRST_STATE) {
            return DEPENDENT > 0 && i->now.mode == INITIALIZATION && known < FIRST_INPUT ? NAN : 0;
        }
        return j->states_by_state[row * STATES + ((int)known - FIRST_STATE)];
    }
    if (unknown < FIRST_OUTPUT) {
        const int row = (int)unknown - FIRST_RATE;
        by_state = j->rates_by_state + row * STATES;
        by_input = j->rates_by_input + row * ALL_INPUTS;
        by_parameter = j->rates_by_parameter + row * PARAMETERS;
    } else {
        const int row = (int)unknown - FIRST_OUTPUT;
        by_state = j->outputs_by_state + row * STATES;
        by_input = j->outputs_by_input + row * ALL_INPUTS;
        by_parameter = j->outputs_by_parameter + row * PARAMETERS;
    }
    if (known < FIRST_INPUT) {
        /* Dependent coordinates would follow. */
        return DEPENDENT > 0 && i->now.mode == INITIALIZATION ? NAN : by_parameter[(int)known - FIRST_PARAMETER];
    }
    if (known < FIRST_STATE) {
        return by_input[(int)known - FIRST_INPUT];
    }
    return by_way_of_states(j, by_state, (int)known - FIRST_STATE);
}

/* Products of the Jacobian with a seed, from the right or, for the adjoint, from the left. */
static fmi3Status products(
    const Instance *i, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[],
    size_t nKnowns, const double seed[], double sensitivity[], int adjoint
) {
    const size_t results = adjoint ? nKnowns : nUnknowns, seeds = adjoint ? nUnknowns : nKnowns;
    Jacobians *j = calloc(1, sizeof *j);
    fmi3Status status = fmi3OK;
    size_t row, column;
    if (!j || !jacobians_of(i, j)) {
        free(j);
        return told(i, "derivatives: there are none at this place");
    }
    for (row = 0; row < results && status == fmi3OK; row++) {
        sensitivity[row] = 0;
        for (column = 0; column < seeds; column++) {
            const fmi3ValueReference unknown = unknowns[adjoint ? column : row];
            const fmi3ValueReference known = knowns[adjoint ? row : column];
            const double entry = derivative(i, j, unknown, known);
            if (entry != entry) {
                status = told(
                    i, "derivatives: none of variable %lu by variable %lu", (unsigned long)unknown, (unsigned long)known
                );
                break;
            }
            sensitivity[row] += entry * seed[column];
        }
    }
    free(j);
    return status;
}
