/* An FMU of FMI 3.0 for model exchange and co-simulation. All values are in SI. An instance holds all that changes;
 * nothing is shared between instances. */

/* First of all, as its names are those of a spec, which may be macros elsewhere. */
#include "fmi-equations.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi-motion.h"
#include "fmi-types.h"

#ifdef FMI3_FUNCTION_PREFIX
#define JOINED_(a, b) a##b
#define JOINED(a, b) JOINED_(a, b)
#define API(name) JOINED(FMI3_FUNCTION_PREFIX, name)
#else
#define API(name) name
#endif

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* What an instance is doing. */
enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    EVENT = 4,
    CONTINUOUS = 8,
    STEP = 16,
    TERMINATED = 32
};

/* Value references: one after the other. */
enum {
    TIME = 0,
    FIRST_PARAMETER = 1,
    FIRST_INPUT = FIRST_PARAMETER + PARAMETERS,
    FIRST_STATE = FIRST_INPUT + INPUTS,
    FIRST_RATE = FIRST_STATE + STATES,
    FIRST_OUTPUT = FIRST_RATE + STATES,
    FIRST_SWITCH = FIRST_OUTPUT + OUTPUTS,
    VARIABLES = FIRST_SWITCH + SWITCHES
};

typedef struct {
    Motion now;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Instance;

/* Tells what is wrong. */
static fmi3Status told(const Instance *instance, const char *format, ...) {
    if (instance && instance->log) {
        char message[512];
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message, sizeof message, format, arguments);
        va_end(arguments);
        instance->log(instance->environment, fmi3Error, "logStatusError", message);
    }
    return fmi3Error;
}

/* Where the integration of co-simulation can be wrong. */
#define UNSEEN \
    "Steps end where time switches the equations, which is sought at eighths of each step: a pulse that is shorter than " \
    "an eighth of the communication step can be passed over."

/* Whether a function may be called now. */
static int allowed(const Instance *instance, int modes, const char *function) {
    if (!instance) {
        return 0;
    }
    if (!(instance->now.mode & modes)) {
        told(instance, "%s: not allowed in the present mode", function);
        return 0;
    }
    return 1;
}

/* The values of the spec. */
static void set_defaults(Motion *m) {
    const int32_t co_simulation = m->co_simulation;
    memset(m, 0, sizeof *m);
    m->co_simulation = co_simulation;
    m->mode = INSTANTIATED;
    m->tolerance = DEFAULT_TOLERANCE;
    memcpy(m->x, initial_state, sizeof m->x);
    memcpy(m->p, default_parameters, sizeof m->p);
    m->since_u = HUGE_VAL;
    m->floor = -HUGE_VAL;
    m->next_row = HUGE_VAL;
}

static fmi3Instance instantiated(
    const char *given, int co_simulation, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log
) {
    Instance *instance;
    Instance made;
    memset(&made, 0, sizeof made);
    made.environment = environment;
    made.log = log;
    if (!given || strcmp(given, INSTANTIATION_TOKEN) != 0) {
        told(&made, "instantiation: the token is not that of this FMU");
        return NULL;
    }
    instance = calloc(1, sizeof *instance);
    if (!instance) {
        told(&made, "instantiation: out of memory");
        return NULL;
    }
    *instance = made;
    instance->now.co_simulation = co_simulation;
    set_defaults(&instance->now);
    return instance;
}

/* The time at which equations are evaluated. Between events of model exchange they are those after the last event
 * and before the next one, even where a solver looks beyond. */
static double seen_time(const Motion *m) {
    double t = m->t, jump;
    if (m->mode != CONTINUOUS) {
        return t;
    }
    t = larger(t, m->floor);
    t = t >= m->next_row ? before(m->next_row) : t;
    if (t > m->since && switches_differ(m, t, m->switched) && jump_within(m, m->since, t, &jump)) {
        t = before(jump);
    }
    return t;
}

/* Takes the present time as that of an event. A time that is rounded counts as the row that it means. */
static void take_event(Motion *m) {
    const double reach = 4 * DBL_EPSILON * larger(fabs(m->t), 1.0);
    const double row = next_row(m->t, HUGE_VAL);
    m->floor = row - m->t <= reach ? row : m->t;
    m->next_row = next_row(m->floor, HUGE_VAL);
    m->since = larger(m->t, m->floor);
    if (SWITCHES > 0) {
        switches_at(m, m->since, m->switched);
    }
}

/* The state, which is consistent once initialisation has begun. */
static int state_of(const Instance *instance, double *x) {
    const Motion *m = &instance->now;
    memcpy(x, m->x, sizeof m->x);
    if (m->mode == INITIALIZATION && !restore(m, m->t, x, 1)) {
        told(
            instance, "no values of the dependent coordinates near their start values satisfy the position constraints"
        );
        return 0;
    }
    return 1;
}

/* Instances */

EXPORT const char *API(fmi3GetVersion)(void) {
    return "3.0";
}

EXPORT fmi3Status API(fmi3SetDebugLogging)(
    fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories, const fmi3String categories[]
) {
    (void)loggingOn;
    (void)nCategories;
    (void)categories;
    return instance ? fmi3OK : fmi3Error;
}

EXPORT fmi3Instance API(fmi3InstantiateModelExchange)(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage
) {
    (void)instanceName;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    return instantiated(instantiationToken, 0, instanceEnvironment, logMessage);
}

EXPORT fmi3Instance API(fmi3InstantiateCoSimulation)(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
    const fmi3ValueReference requiredIntermediateVariables[], size_t nRequiredIntermediateVariables,
    fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3IntermediateUpdateCallback intermediateUpdate
) {
    (void)instanceName;
    fmi3Instance made;
    (void)resourcePath;
    (void)visible;
    (void)eventModeUsed;
    (void)earlyReturnAllowed;
    (void)requiredIntermediateVariables;
    (void)nRequiredIntermediateVariables;
    (void)intermediateUpdate;
    made = instantiated(instantiationToken, 1, instanceEnvironment, logMessage);
    if (made && SWITCHES > 0 && loggingOn && logMessage) {
        logMessage(instanceEnvironment, fmi3Warning, "logStatusWarning", UNSEEN);
    }
    return made;
}

EXPORT fmi3Instance API(fmi3InstantiateScheduledExecution)(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption
) {
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)instanceEnvironment;
    (void)logMessage;
    (void)clockUpdate;
    (void)lockPreemption;
    (void)unlockPreemption;
    return NULL;
}

EXPORT void API(fmi3FreeInstance)(fmi3Instance instance) {
    free(instance);
}

EXPORT fmi3Status API(fmi3EnterInitializationMode)(
    fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance, fmi3Float64 startTime,
    fmi3Boolean stopTimeDefined, fmi3Float64 stopTime
) {
    Instance *i = instance;
    (void)stopTimeDefined;
    (void)stopTime;
    if (!allowed(i, INSTANTIATED, "fmi3EnterInitializationMode")) {
        return fmi3Error;
    }
    if (!isfinite(startTime) || (toleranceDefined && !(tolerance > 0 && tolerance < 1))) {
        return told(i, "fmi3EnterInitializationMode: start time %g, tolerance %g", startTime, tolerance);
    }
    if (toleranceDefined) {
        i->now.tolerance = larger(tolerance, LEAST_TOLERANCE);
    }
    i->now.t = startTime;
    i->now.mode = INITIALIZATION;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3ExitInitializationMode)(fmi3Instance instance) {
    Instance *i = instance;
    double x[STATES];
    if (!allowed(i, INITIALIZATION, "fmi3ExitInitializationMode") || !state_of(i, x)) {
        return fmi3Error;
    }
    memcpy(i->now.x, x, sizeof x);
    i->now.mode = i->now.co_simulation ? STEP : EVENT;
    take_event(&i->now);
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3EnterEventMode)(fmi3Instance instance) {
    Instance *i = instance;
    if (!allowed(i, CONTINUOUS, "fmi3EnterEventMode")) {
        return fmi3Error;
    }
    i->now.mode = EVENT;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3Terminate)(fmi3Instance instance) {
    Instance *i = instance;
    if (!allowed(i, EVENT | CONTINUOUS | STEP, "fmi3Terminate")) {
        return fmi3Error;
    }
    i->now.mode = TERMINATED;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3Reset)(fmi3Instance instance) {
    Instance *i = instance;
    if (!i) {
        return fmi3Error;
    }
    set_defaults(&i->now);
    return fmi3OK;
}

/* Values */

EXPORT fmi3Status API(fmi3GetFloat64)(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Float64 values[],
    size_t nValues
) {
    const Instance *i = instance;
    double x[STATES] = {0}, u[ROOM(ALL_INPUTS)] = {0}, rates[STATES], outputs[ROOM(OUTPUTS)], switched[ROOM(SWITCHES)], t;
    int has_state = 0, has_rates = 0, has_outputs = 0;
    size_t k;
    if (!i || nValues != nValueReferences) {
        return told(i, "fmi3GetFloat64: as many values as variables are needed");
    }
    t = seen_time(&i->now);
    for (k = 0; k < nValues; k++) {
        const fmi3ValueReference all = valueReferences[k];
        const int v = all < VARIABLES ? (int)all : VARIABLES;
        if (v == VARIABLES) {
            return told(i, "fmi3GetFloat64: there is no variable %lu", (unsigned long)all);
        }
        if (v >= FIRST_STATE && !has_state) {
            if (!state_of(i, x)) {
                return fmi3Error;
            }
            fill_inputs(&i->now, t, u);
            has_state = 1;
        }
        if (v == TIME) {
            values[k] = i->now.t;
        } else if (v < FIRST_INPUT) {
            values[k] = i->now.p[v - FIRST_PARAMETER];
        } else if (v < FIRST_STATE) {
            values[k] = i->now.u[v - FIRST_INPUT];
        } else if (v < FIRST_RATE) {
            values[k] = x[v - FIRST_STATE];
        } else if (v < FIRST_OUTPUT) {
            if (!has_rates) {
                rates_of_model(t, i->now.p, x, u, rates);
                has_rates = 1;
            }
            values[k] = rates[v - FIRST_RATE];
        } else if (v < FIRST_SWITCH) {
            if (!has_outputs) {
                outputs_of_model(t, i->now.p, x, u, outputs);
                has_outputs = 1;
            }
            values[k] = outputs[v - FIRST_OUTPUT];
        } else {
            switches_at(&i->now, i->now.t, switched);
            values[k] = switched[v - FIRST_SWITCH] != i->now.switched[v - FIRST_SWITCH] ? -1 : 1;
        }
    }
    return fmi3OK;
}

static int within(int v, int first, int end) {
    return v >= first && v < end;
}

EXPORT fmi3Status API(fmi3SetFloat64)(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
    const fmi3Float64 values[], size_t nValues
) {
    const int early = INSTANTIATED | INITIALIZATION;
    Instance *i = instance;
    size_t k;
    if (!i || nValues != nValueReferences) {
        return told(i, "fmi3SetFloat64: as many values as variables are needed");
    }
    for (k = 0; k < nValues; k++) {
        const fmi3ValueReference all = valueReferences[k];
        const int v = all < VARIABLES ? (int)all : VARIABLES;
        if (within(v, FIRST_PARAMETER, FIRST_INPUT)) {
            const int parameter = v - FIRST_PARAMETER;
            if (!(i->now.mode & (parameter_is_fixed[parameter] ? early : early | EVENT | STEP))) {
                return told(i, "fmi3SetFloat64: parameter %d cannot be set now", v);
            }
            i->now.p[parameter] = values[k];
        } else if (within(v, FIRST_INPUT, FIRST_STATE)) {
            i->now.u[v - FIRST_INPUT] = values[k];
            i->now.slopes[v - FIRST_INPUT] = 0;
        } else if (within(v, FIRST_STATE, FIRST_RATE)) {
            if (!(i->now.mode & early)) {
                return told(i, "fmi3SetFloat64: state %d can only be set before the motion begins", v);
            }
            i->now.x[v - FIRST_STATE] = values[k];
        } else {
            return told(i, "fmi3SetFloat64: there is no variable %lu that can be set", (unsigned long)all);
        }
    }
    return fmi3OK;
}

/* Snapshots */

EXPORT fmi3Status API(fmi3GetFMUState)(fmi3Instance instance, fmi3FMUState *FMUState) {
    const Instance *i = instance;
    if (!i || !FMUState) {
        return fmi3Error;
    }
    if (!*FMUState) {
        *FMUState = calloc(1, sizeof(Motion));
    }
    if (!*FMUState) {
        return told(i, "fmi3GetFMUState: out of memory");
    }
    memcpy(*FMUState, &i->now, sizeof i->now);
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3SetFMUState)(fmi3Instance instance, fmi3FMUState FMUState) {
    Instance *i = instance;
    const Motion *kept = FMUState;
    if (!i || !kept) {
        return fmi3Error;
    }
    if (kept->co_simulation != i->now.co_simulation) {
        return told(i, "fmi3SetFMUState: the state is one of the other interface type");
    }
    i->now = *kept;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3FreeFMUState)(fmi3Instance instance, fmi3FMUState *FMUState) {
    (void)instance;
    if (FMUState) {
        free(*FMUState);
        *FMUState = NULL;
    }
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState FMUState, size_t *size) {
    if (!instance || !FMUState || !size) {
        return fmi3Error;
    }
    *size = sizeof(Motion);
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3SerializeFMUState)(
    fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size
) {
    if (!instance || !FMUState || size < sizeof(Motion)) {
        return fmi3Error;
    }
    memcpy(serializedState, FMUState, sizeof(Motion));
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3DeserializeFMUState)(
    fmi3Instance instance, const fmi3Byte serializedState[], size_t size, fmi3FMUState *FMUState
) {
    const Instance *i = instance;
    if (!i || !FMUState) {
        return fmi3Error;
    }
    if (size != sizeof(Motion)) {
        return told(i, "fmi3DeserializeFMUState: the state is one of another FMU");
    }
    if (!*FMUState) {
        *FMUState = calloc(1, sizeof(Motion));
    }
    if (!*FMUState) {
        return told(i, "fmi3DeserializeFMUState: out of memory");
    }
    memcpy(*FMUState, serializedState, sizeof(Motion));
    return fmi3OK;
}

/* Derivatives */

#include "fmi-derivatives.h"

EXPORT fmi3Status API(fmi3GetDirectionalDerivative)(
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[],
    size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity
) {
    if (!instance || nSeed != nKnowns || nSensitivity != nUnknowns) {
        return told(instance, "fmi3GetDirectionalDerivative: one seed per known and one result per unknown are needed");
    }
    return products(instance, unknowns, nUnknowns, knowns, nKnowns, seed, sensitivity, 0);
}

EXPORT fmi3Status API(fmi3GetAdjointDerivative)(
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[],
    size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity
) {
    if (!instance || nSeed != nUnknowns || nSensitivity != nKnowns) {
        return told(instance, "fmi3GetAdjointDerivative: one seed per unknown and one result per known are needed");
    }
    return products(instance, unknowns, nUnknowns, knowns, nKnowns, seed, sensitivity, 1);
}

/* Model exchange */

EXPORT fmi3Status API(fmi3EvaluateDiscreteStates)(fmi3Instance instance) {
    return instance ? fmi3OK : fmi3Error;
}

EXPORT fmi3Status API(fmi3UpdateDiscreteStates)(
    fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate, fmi3Boolean *terminateSimulation,
    fmi3Boolean *nominalsOfContinuousStatesChanged, fmi3Boolean *valuesOfContinuousStatesChanged,
    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime
) {
    Instance *i = instance;
    if (!allowed(i, EVENT, "fmi3UpdateDiscreteStates")) {
        return fmi3Error;
    }
    take_event(&i->now);
    *discreteStatesNeedUpdate = false;
    *terminateSimulation = false;
    *nominalsOfContinuousStatesChanged = false;
    *valuesOfContinuousStatesChanged = false;
    *nextEventTimeDefined = i->now.next_row < HUGE_VAL;
    *nextEventTime = *nextEventTimeDefined ? i->now.next_row : 0;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3EnterContinuousTimeMode)(fmi3Instance instance) {
    Instance *i = instance;
    if (!allowed(i, EVENT, "fmi3EnterContinuousTimeMode")) {
        return fmi3Error;
    }
    i->now.mode = CONTINUOUS;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3CompletedIntegratorStep)(
    fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *enterEventMode,
    fmi3Boolean *terminateSimulation
) {
    Instance *i = instance;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!allowed(i, CONTINUOUS, "fmi3CompletedIntegratorStep")) {
        return fmi3Error;
    }
    /* Jumps are sought from here on. */
    if (i->now.t > i->now.since && !switches_differ(&i->now, i->now.t, i->now.switched)) {
        i->now.since = i->now.t;
    }
    *enterEventMode = false;
    *terminateSimulation = false;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3SetTime)(fmi3Instance instance, fmi3Float64 time) {
    Instance *i = instance;
    if (!allowed(i, EVENT | CONTINUOUS, "fmi3SetTime")) {
        return fmi3Error;
    }
    i->now.t = time;
    return fmi3OK;
}

static int fits(const Instance *i, size_t count, size_t expected, const char *function) {
    if (!i || count != expected) {
        told(i, "%s: %lu numbers are needed", function, (unsigned long)expected);
        return 0;
    }
    return 1;
}

EXPORT fmi3Status API(fmi3SetContinuousStates)(
    fmi3Instance instance, const fmi3Float64 continuousStates[], size_t nContinuousStates
) {
    Instance *i = instance;
    if (!fits(i, nContinuousStates, STATES, "fmi3SetContinuousStates") ||
        !allowed(i, EVENT | CONTINUOUS, "fmi3SetContinuousStates")) {
        return fmi3Error;
    }
    memcpy(i->now.x, continuousStates, sizeof i->now.x);
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3GetContinuousStates)(
    fmi3Instance instance, fmi3Float64 continuousStates[], size_t nContinuousStates
) {
    const Instance *i = instance;
    if (!fits(i, nContinuousStates, STATES, "fmi3GetContinuousStates") || !state_of(i, continuousStates)) {
        return fmi3Error;
    }
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3GetContinuousStateDerivatives)(
    fmi3Instance instance, fmi3Float64 derivatives[], size_t nContinuousStates
) {
    const Instance *i = instance;
    double x[STATES];
    if (!fits(i, nContinuousStates, STATES, "fmi3GetContinuousStateDerivatives") || !state_of(i, x)) {
        return fmi3Error;
    }
    rates_at(&i->now, seen_time(&i->now), x, derivatives);
    if (!all_finite(derivatives, STATES)) {
        told(i, "the rates are not finite at t = %.17g", i->now.t);
        return fmi3Discard;
    }
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3GetNominalsOfContinuousStates)(
    fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates
) {
    int k;
    if (!fits(instance, nContinuousStates, STATES, "fmi3GetNominalsOfContinuousStates")) {
        return fmi3Error;
    }
    for (k = 0; k < STATES; k++) {
        nominals[k] = 1;
    }
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3GetEventIndicators)(
    fmi3Instance instance, fmi3Float64 eventIndicators[], size_t nEventIndicators
) {
    fmi3ValueReference references[ROOM(SWITCHES)] = {0};
    int k;
    if (!fits(instance, nEventIndicators, SWITCHES, "fmi3GetEventIndicators")) {
        return fmi3Error;
    }
    for (k = 0; k < SWITCHES; k++) {
        references[k] = (fmi3ValueReference)(FIRST_SWITCH + k);
    }
    return API(fmi3GetFloat64)(instance, references, SWITCHES, eventIndicators, SWITCHES);
}

EXPORT fmi3Status API(fmi3GetNumberOfEventIndicators)(fmi3Instance instance, size_t *nEventIndicators) {
    if (!instance || !nEventIndicators) {
        return fmi3Error;
    }
    *nEventIndicators = SWITCHES;
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3GetNumberOfContinuousStates)(fmi3Instance instance, size_t *nContinuousStates) {
    if (!instance || !nContinuousStates) {
        return fmi3Error;
    }
    *nContinuousStates = STATES;
    return fmi3OK;
}

/* Co-simulation */

EXPORT fmi3Status API(fmi3DoStep)(
    fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
    fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
    fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime
) {
    static const char *const reasons[] = {
        "", "the rates are not finite", "no step is short enough for the tolerance", "too many steps"
    };
    Instance *i = instance;
    const double end = currentCommunicationPoint + communicationStepSize;
    Ending ending;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!allowed(i, STEP, "fmi3DoStep")) {
        return fmi3Error;
    }
    *eventHandlingNeeded = false;
    *terminateSimulation = false;
    *earlyReturn = false;
    *lastSuccessfulTime = i->now.t;
    if (!(communicationStepSize > 0) || !isfinite(end) ||
        !(fabs(currentCommunicationPoint - i->now.t) <= 1e-9 * larger(fabs(i->now.t), communicationStepSize))) {
        return told(
            i, "fmi3DoStep: a step of %g s from t = %.17g, but the motion has come to t = %.17g", communicationStepSize,
            currentCommunicationPoint, i->now.t
        );
    }
    i->now.t = currentCommunicationPoint;
    draw_lines(&i->now);
    ending = move_to(&i->now, end);
    *lastSuccessfulTime = i->now.t;
    if (ending != DONE) {
        return told(i, "fmi3DoStep: %s at t = %.17g", reasons[ending], i->now.t);
    }
    return fmi3OK;
}

EXPORT fmi3Status API(fmi3EnterStepMode)(fmi3Instance instance) {
    return told(instance, "fmi3EnterStepMode: there is no event mode in co-simulation");
}

EXPORT fmi3Status API(fmi3GetOutputDerivatives)(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
    const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues
) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)orders;
    (void)values;
    (void)nValues;
    return told(instance, "fmi3GetOutputDerivatives: not provided");
}

#include "fmi-absent.h"
