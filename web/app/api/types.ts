/** The daemon's types, generated from its specification, under the names that the pages use. */
import type { components } from '../../gen/schema';

type Schemas = components['schemas'];

export type Autopilot = Schemas['Autopilot'];
export type AutopilotStep = Schemas['AutopilotStep'];
export type Bench = Schemas['Bench'];
export type Channel = Schemas['ChannelInfo'];
export type Comparison = Schemas['Comparison'];
export type Diagnosis = Schemas['Diagnosis'];
export type Effect = Schemas['Effect'];
export type EffectCheck = Schemas['EffectCheck'];
export type EffectDefinition = Schemas['EffectDefinition'];
export type Exclusion = Schemas['Exclusion'];
export type Experiment = Schemas['Experiment'];
export type Beside = Schemas['Beside'];
export type Identification = Schemas['Identification'];
export type IdentifiedQuantity = Schemas['Quantity'];
export type LiveMessage = Schemas['LiveMessage'];
export type Model = Schemas['Model'];
export type NewAutopilot = Schemas['NewAutopilot'];
export type Parameter = Schemas['FittedParameter'];
export type Place = Schemas['Place'];
export type Preview = Schemas['Preview'];
export type Problem = Schemas['Problem'];
export type Procedure = Schemas['Procedure'];
export type ProcedureParameter = Schemas['ProcedureParameter'];
export type Progress = Schemas['Progress'];
export type Region = Schemas['Region'];
export type ResidualSet = Schemas['ResidualSet'];
export type Run = Schemas['Run'];
export type RunEvent = Schemas['RunEvent'];
export type RunSummary = Schemas['RunSummary'];
export type RunState = Schemas['RunState'];
export type Samples = Schemas['Samples'];
export type Suggestion = Schemas['Suggestion'];
export type TradeOff = Schemas['TradeOff'];
export type Worth = Schemas['Worth'];
