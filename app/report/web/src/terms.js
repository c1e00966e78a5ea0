// Definitions of terms, in the same words as `modebank help TERM`.
import terms from '../terms.json';

import {Glossary} from './glossary.js';

const glossary = new Glossary(terms);

export const meaningOf = (heading) => glossary.meaningOf(heading);
