/* Functions for what this FMU has not: other types, clocks, configuration, partitions. All of them are errors, except
 * for no variables. */

#define ABSENT(count, name)                                                                                            \
    do {                                                                                                               \
        if ((count) == 0 && instance) {                                                                                \
            return fmi3OK;                                                                                             \
        }                                                                                                              \
        return told(instance, name ": there is no such variable");                                                     \
    } while (0)

#define ABSENT_TYPE(kind)                                                                                              \
    EXPORT fmi3Status API(fmi3Get##kind)(                                                                              \
        fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,                    \
        fmi3##kind values[], size_t nValues                                                                            \
    ) {                                                                                                                \
        (void)valueReferences;                                                                                         \
        (void)values;                                                                                                  \
        (void)nValues;                                                                                                 \
        ABSENT(nValueReferences, "fmi3Get" #kind);                                                                     \
    }                                                                                                                  \
    EXPORT fmi3Status API(fmi3Set##kind)(                                                                              \
        fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,                    \
        const fmi3##kind values[], size_t nValues                                                                      \
    ) {                                                                                                                \
        (void)valueReferences;                                                                                         \
        (void)values;                                                                                                  \
        (void)nValues;                                                                                                 \
        ABSENT(nValueReferences, "fmi3Set" #kind);                                                                     \
    }

ABSENT_TYPE(Float32)
ABSENT_TYPE(Int8)
ABSENT_TYPE(UInt8)
ABSENT_TYPE(Int16)
ABSENT_TYPE(UInt16)
ABSENT_TYPE(Int32)
ABSENT_TYPE(UInt32)
ABSENT_TYPE(Int64)
ABSENT_TYPE(UInt64)
ABSENT_TYPE(Boolean)
ABSENT_TYPE(String)

EXPORT fmi3Status API(fmi3GetBinary)(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, size_t valueSizes[],
    fmi3Binary values[], size_t nValues
) {
    (void)valueReferences;
    (void)valueSizes;
    (void)values;
    (void)nValues;
    ABSENT(nValueReferences, "fmi3GetBinary");
}

EXPORT fmi3Status API(fmi3SetBinary)(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
    const size_t valueSizes[], const fmi3Binary values[], size_t nValues
) {
    (void)valueReferences;
    (void)valueSizes;
    (void)values;
    (void)nValues;
    ABSENT(nValueReferences, "fmi3SetBinary");
}

/* Functions of a list of clocks, with one or two more lists. */
#define ABSENT_CLOCK(name, one)                                                                                        \
    EXPORT fmi3Status API(name)(                                                                                       \
        fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, one first[]        \
    ) {                                                                                                                \
        (void)valueReferences;                                                                                         \
        (void)first;                                                                                                   \
        ABSENT(nValueReferences, #name);                                                                               \
    }

#define ABSENT_CLOCK_PAIR(name, one, two)                                                                              \
    EXPORT fmi3Status API(name)(                                                                                       \
        fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, one first[],       \
        two second[]                                                                                                   \
    ) {                                                                                                                \
        (void)valueReferences;                                                                                         \
        (void)first;                                                                                                   \
        (void)second;                                                                                                  \
        ABSENT(nValueReferences, #name);                                                                               \
    }

ABSENT_CLOCK(fmi3GetClock, fmi3Clock)
ABSENT_CLOCK(fmi3SetClock, const fmi3Clock)
ABSENT_CLOCK_PAIR(fmi3GetIntervalDecimal, fmi3Float64, fmi3IntervalQualifier)
ABSENT_CLOCK(fmi3SetIntervalDecimal, const fmi3Float64)
ABSENT_CLOCK_PAIR(fmi3SetIntervalFraction, const fmi3UInt64, const fmi3UInt64)
ABSENT_CLOCK(fmi3GetShiftDecimal, fmi3Float64)
ABSENT_CLOCK(fmi3SetShiftDecimal, const fmi3Float64)
ABSENT_CLOCK_PAIR(fmi3GetShiftFraction, fmi3UInt64, fmi3UInt64)
ABSENT_CLOCK_PAIR(fmi3SetShiftFraction, const fmi3UInt64, const fmi3UInt64)

EXPORT fmi3Status API(fmi3GetIntervalFraction)(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3UInt64 counters[],
    fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]
) {
    (void)valueReferences;
    (void)counters;
    (void)resolutions;
    (void)qualifiers;
    ABSENT(nValueReferences, "fmi3GetIntervalFraction");
}

EXPORT fmi3Status API(fmi3GetNumberOfVariableDependencies)(
    fmi3Instance instance, fmi3ValueReference valueReference, size_t *nDependencies
) {
    (void)valueReference;
    (void)nDependencies;
    return told(instance, "fmi3GetNumberOfVariableDependencies: not provided");
}

EXPORT fmi3Status API(fmi3GetVariableDependencies)(
    fmi3Instance instance, fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
    fmi3ValueReference independents[], size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[],
    size_t nDependencies
) {
    (void)dependent;
    (void)elementIndicesOfDependent;
    (void)independents;
    (void)elementIndicesOfIndependents;
    (void)dependencyKinds;
    (void)nDependencies;
    return told(instance, "fmi3GetVariableDependencies: not provided");
}

EXPORT fmi3Status API(fmi3EnterConfigurationMode)(fmi3Instance instance) {
    return told(instance, "fmi3EnterConfigurationMode: there are no structural parameters");
}

EXPORT fmi3Status API(fmi3ExitConfigurationMode)(fmi3Instance instance) {
    return told(instance, "fmi3ExitConfigurationMode: there are no structural parameters");
}

EXPORT fmi3Status API(fmi3ActivateModelPartition)(
    fmi3Instance instance, fmi3ValueReference clockReference, fmi3Float64 activationTime
) {
    (void)clockReference;
    (void)activationTime;
    return told(instance, "fmi3ActivateModelPartition: there are no partitions");
}
