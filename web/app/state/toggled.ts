/** The list without the value if it contains it, else with the value at its end. */
export const toggled = <T>(list: readonly T[], value: T): T[] => (list.includes(value) ? list.filter((one) => one !== value) : [...list, value]);
